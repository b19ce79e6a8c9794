#include "search/plan_improvement.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "task/state_registry.hpp"
#include "task/successor.hpp"

namespace explicable {

namespace {

// Executes steps on one packed state.
class Walker {
public:
    explicit Walker(const Question& question)
        : question_(question), packer_(question.task), state_(packer_.num_words()), next_(packer_.num_words()) {
        packer_.pack(question.initial, state_.data());
    }
    const std::vector<Word>& state() const { return state_; }
    void jump(const std::vector<Word>& state) { state_ = state; }
    bool all_hold(std::span<const FactId> facts) const {
        return std::all_of(facts.begin(), facts.end(), [this](FactId fact) { return packer_.holds(state_.data(), fact); });
    }
    bool is_applicable(OperatorId step) const { return all_hold(question_.task.preconditions[step]); }
    bool is_goal() const { return all_hold(question_.goal); }
    void execute(OperatorId step) {
        apply(question_.task, packer_, step, state_.data(), next_.data());
        std::swap(state_, next_);
    }

private:
    const Question& question_;
    StatePacker packer_;
    std::vector<Word> state_, next_;
};

// States near a plan, in the order of their distance from it, and the transitions between them.
class Neighbourhood {
public:
    explicit Neighbourhood(const Question& question)
        : question_(question), packer_(question.task), states_(packer_.num_words()), words_(packer_.num_words()) {}

    void grow(const std::vector<OperatorId>& plan, std::size_t max_transitions) {
        Walker walker(question_);
        states_.insert(walker.state().data());
        for (const OperatorId step : plan) {
            walker.execute(step);
            states_.insert(walker.state().data());
        }
        std::vector<OperatorId> applicable;
        State state;
        while (first_transition_.size() < static_cast<std::size_t>(states_.size()) &&
               transitions_.size() < max_transitions) {
            const auto from = static_cast<StateId>(first_transition_.size());
            first_transition_.push_back(transitions_.size());
            state = packer_.unpack(states_[from]);
            question_.successors.applicable(state, applicable);
            for (const OperatorId step : applicable) {
                apply(question_.task, packer_, step, states_[from], words_.data());
                transitions_.push_back({states_.insert(words_.data()).first, step});
            }
        }
        first_transition_.push_back(transitions_.size());
    }

    // Dijkstra from the initial state; an empty plan and false where no goal state has been found.
    std::pair<std::vector<OperatorId>, bool> cheapest_plan() const {
        std::vector<Reached> reached(states_.size());
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
        reached[0].cost = 0;
        open.emplace(0, 0);
        while (!open.empty()) {
            const auto [cost, from] = open.top();
            open.pop();
            if (cost > reached[from].cost) continue;
            if (question_.is_goal(packer_.unpack(states_[from]))) return {path(reached, from), true};
            if (static_cast<std::size_t>(from) + 1 >= first_transition_.size()) continue;
            for (std::size_t i = first_transition_[from]; i < first_transition_[from + 1]; ++i) {
                const auto [to, step] = transitions_[i];
                const std::int64_t through = cost + question_.task.cost[step];
                if (through >= reached[to].cost) continue;
                reached[to] = {through, from, step};
                open.emplace(through, to);
            }
        }
        return {{}, false};
    }

private:
    struct Transition {
        StateId to;
        OperatorId step;
    };
    struct Reached {
        std::int64_t cost = std::numeric_limits<std::int64_t>::max();
        StateId from = -1;
        OperatorId step = -1;
    };
    using Entry = std::pair<std::int64_t, StateId>;

    const Question& question_;
    StatePacker packer_;
    StateRegistry states_;
    std::vector<Word> words_;
    std::vector<std::size_t> first_transition_;  // of the states that have been expanded, and one more
    std::vector<Transition> transitions_;

    static std::vector<OperatorId> path(const std::vector<Reached>& reached, StateId state) {
        std::vector<OperatorId> steps;
        for (; reached[state].from >= 0; state = reached[state].from) steps.push_back(reached[state].step);
        std::reverse(steps.begin(), steps.end());
        return steps;
    }
};

std::int64_t cost_of(const Task& task, const std::vector<OperatorId>& plan) {
    std::int64_t sum = 0;
    for (const OperatorId step : plan) sum += task.cost[step];
    return sum;
}

}  // namespace

std::vector<OperatorId> eliminate_actions(const Question& question, std::vector<OperatorId> plan,
                                          std::int64_t max_executions) {
    Walker walker(question);
    const std::vector<Word> initial = walker.state();
    std::vector<OperatorId> shorter;
    for (bool changed = true; std::exchange(changed, false);) {
        std::vector<Word> before = initial;
        for (std::size_t dropped = 0; dropped < plan.size();) {
            max_executions -= std::ssize(plan) - static_cast<std::int64_t>(dropped);
            if (max_executions < 0) return plan;
            walker.jump(before);
            shorter.assign(plan.begin(), plan.begin() + static_cast<std::ptrdiff_t>(dropped));
            for (std::size_t i = dropped + 1; i < plan.size(); ++i) {
                if (!walker.is_applicable(plan[i])) continue;
                walker.execute(plan[i]);
                shorter.push_back(plan[i]);
            }
            if (walker.is_goal()) {
                plan.swap(shorter);
                changed = true;
                continue;
            }
            walker.jump(before);
            walker.execute(plan[dropped++]);
            before = walker.state();
        }
    }
    return plan;
}

std::vector<OperatorId> search_neighbourhood(const Question& question, std::vector<OperatorId> plan,
                                             std::size_t max_transitions) {
    Neighbourhood neighbourhood(question);
    neighbourhood.grow(plan, max_transitions);
    auto [cheapest, found] = neighbourhood.cheapest_plan();
    return found && cost_of(question.task, cheapest) < cost_of(question.task, plan) ? std::move(cheapest) : plan;
}

}  // namespace explicable
