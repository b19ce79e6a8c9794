#include "search/way_finder.hpp"

#include <span>
#include <utility>

#include "search/open_list.hpp"
#include "search/solve.hpp"
#include "task/state_registry.hpp"
#include "task/successor.hpp"

namespace explicable {

namespace {

constexpr std::int64_t most_within_bound = 200'000;  // evaluations, a few microseconds each

// Unpacks what a step may have changed: on a large map, little of a state with all that is believed of its cells.
void refresh(const Task& task, const StatePacker& packer, OperatorId step, const Word* words, State& state) {
    const auto look_at = [&](std::span<const FactId> facts) {
        for (const FactId fact : facts) state.values[task.fact_variable[fact]] = packer.get(words, task.fact_variable[fact]);
    };
    look_at(task.adds[step]);
    look_at(task.deletes[step]);
    for (auto effect = task.effect_offsets[step]; effect < task.effect_offsets[step + 1]; ++effect) {
        look_at(task.effect_adds[effect]);
        look_at(task.effect_deletes[effect]);
    }
}

}  // namespace

WayFinder::Answer WayFinder::find(const Question& question, const Limits& limits) {
    if (question.is_goal(question.initial)) return {true, std::vector<OperatorId>()};
    const auto around = tour(question);
    if (around->exists()) {
        if (auto plan = descend(question, *around, limits.evaluations)) return {true, std::move(plan)};
        if (around->is_tighter() && around->cost(question.initial) < dead_end) {
            if (auto plan = search_within_bound(question, *around, most_within_bound)) return {true, std::move(plan)};
        }
    }
    SearchOptions options;
    options.algorithm = "astar";
    options.heuristic = "tour";
    Monitor monitor(limits, {});
    SearchAnswer answer = solve(question, options, monitor);
    return {answer.outcome == Outcome::solved || answer.outcome == Outcome::unsolvable, std::move(answer.plan)};
}

// Two questions have the same tour if they ask for the same goals, of which the same hold, and the same operators are possible.
std::shared_ptr<const Tour> WayFinder::tour(const Question& question) {
    const std::lock_guard lock(mutex_);
    const auto [number, possible] = possible_.find(question.initial);
    std::string key(reinterpret_cast<const char*>(&number), sizeof(number));
    for (const FactId goal : question.goal) {
        key.append(reinterpret_cast<const char*>(&goal), sizeof(goal));
        key.push_back(static_cast<char>(question.initial.holds(question.task, goal)));
    }
    if (const auto known = tours_.find(key); known != tours_.end()) return known->second;
    auto made = std::make_shared<const Tour>(question, possible->operators, moves_);
    const std::size_t bytes = made->memory_bytes() + key.size();
    if (bytes_ + bytes > most_bytes) {
        tours_.clear();
        bytes_ = 0;
    }
    bytes_ += bytes;
    return tours_.emplace(std::move(key), std::move(made)).first->second;
}

// A* takes the node of least f, of those the one of least h, of those the one that came first. So it expands a successor of the
// node that it has just expanded if that is as good in f and better in h: nothing that waits is. For as long as this holds the open
// list is of no use. Gives up where it does not.
std::optional<std::vector<OperatorId>> WayFinder::descend(const Question& question, const Tour& tour, std::int64_t max_evaluations) const {
    std::vector<OperatorId> plan, applicable;
    std::vector<Word> words(packer_.num_words()), next(words.size()), best_words(words.size());
    packer_.pack(question.initial, words.data());
    State state = question.initial;
    double h = tour.cost(state), left = tour.bound(packer_, words.data());  // of what a plan may still cost
    std::int64_t evaluations = 1;
    if (h < left) return std::nullopt;
    while (!question.is_goal(state)) {
        question.successors.applicable(state, applicable);
        evaluations += static_cast<std::int64_t>(applicable.size());
        if (evaluations > max_evaluations) return std::nullopt;
        Key best{h, h};  // f less what the path has cost, and h
        OperatorId first = -1;
        for (const OperatorId step : applicable) {
            apply(question.task, packer_, step, words.data(), next.data());
            const double ahead = tour.cost(packer_, next.data());
            const Key key{question.task.cost[step] + ahead, ahead};
            if (key >= best || question.task.cost[step] + tour.bound(packer_, next.data()) > left) continue;
            best = key;
            first = step;
            best_words = next;
        }
        if (first < 0 || best.first < h) return std::nullopt;
        plan.push_back(first);
        h = best.second;
        left -= question.task.cost[first];
        std::swap(words, best_words);
        refresh(question.task, packer_, first, words.data(), state);
    }
    return plan;
}

// A*, of nodes through which a plan may lead that costs no more than the tighter bound says: if there is one, it is a best one.
std::optional<std::vector<OperatorId>> WayFinder::search_within_bound(const Question& question, const Tour& tour,
                                                                      std::int64_t max_evaluations) const {
    struct Node {
        double cost;
        StateId parent;
        OperatorId step;
        bool is_expanded = false;
    };
    StateRegistry states(packer_.num_words());
    std::vector<Node> nodes;
    OpenList<StateId> open;
    std::vector<Word> words(packer_.num_words());
    std::vector<OperatorId> applicable;
    State state = question.initial;
    packer_.pack(state, words.data());
    const double most = tour.bound(packer_, words.data());
    const auto arrive = [&](Node node) {
        if (node.cost + tour.bound(packer_, words.data()) > most) return;
        const auto [id, is_new] = states.insert(words.data());
        if (is_new) nodes.push_back(node);
        else if (node.cost < nodes[id].cost) nodes[id] = node;
        else return;
        const double ahead = tour.cost(packer_, words.data());
        open.push({node.cost + ahead, ahead}, id);
    };
    arrive({0.0, -1, -1});
    for (std::int64_t evaluations = 1; !open.empty() && evaluations <= max_evaluations;) {
        const StateId id = open.pop();
        if (nodes[id].is_expanded) continue;
        nodes[id].is_expanded = true;
        packer_.unpack(states[id], state);
        if (question.is_goal(state)) {
            std::vector<OperatorId> plan;
            for (StateId at = id; nodes[at].parent >= 0; at = nodes[at].parent) plan.push_back(nodes[at].step);
            return std::vector<OperatorId>(plan.rbegin(), plan.rend());
        }
        question.successors.applicable(state, applicable);
        evaluations += static_cast<std::int64_t>(applicable.size());
        for (const OperatorId step : applicable) {
            apply(question.task, packer_, step, states[id], words.data());
            arrive({nodes[id].cost + question.task.cost[step], id, step});
        }
    }
    return std::nullopt;
}

}  // namespace explicable
