#include "search/goal_order.hpp"

#include <algorithm>

#include "search/hill_climbing.hpp"
#include "search/lazy.hpp"
#include "task/packed_state.hpp"
#include "task/successor.hpp"

namespace explicable {

namespace {

constexpr std::int64_t few = 300;  // evaluations for one goal

State execute(const Task& task, const State& state, const std::vector<OperatorId>& steps) {
    const StatePacker packer(task);
    std::vector<Word> from(packer.num_words()), to(packer.num_words());
    packer.pack(state, from.data());
    for (const OperatorId step : steps) {
        apply(task, packer, step, from.data(), to.data());
        std::swap(from, to);
    }
    return packer.unpack(from.data());
}

}  // namespace

// Goals in the order in which the plan makes them true for good.
std::vector<FactId> GoalOrder::order_of(const std::vector<OperatorId>& plan) const {
    std::vector<std::pair<std::size_t, FactId>> times;
    for (const FactId goal : question_.goal) times.emplace_back(0, goal);
    const StatePacker packer(question_.task);
    std::vector<Word> from(packer.num_words()), to(packer.num_words());
    packer.pack(question_.initial, from.data());
    for (std::size_t step = 0; step < plan.size(); ++step) {
        for (auto& [time, goal] : times)
            if (!packer.holds(from.data(), goal)) time = step + 1;
        apply(question_.task, packer, plan[step], from.data(), to.data());
        std::swap(from, to);
    }
    std::ranges::sort(times);
    std::vector<FactId> order;
    for (const auto& [time, goal] : times) order.push_back(goal);
    return order;
}

// Keeps the first parts of other ones.
std::optional<GoalOrder::Parts> GoalOrder::serialise(const std::vector<FactId>& order, const Parts& kept,
                                                     std::size_t num_kept, Monitor& monitor) const {
    Parts parts(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(num_kept));
    for (std::size_t i = num_kept; i < order.size(); ++i) {
        const State& start = i == 0 ? question_.initial : parts.back().after;
        const Question part(question_.prepared, start, {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(i) + 1});
        std::vector<OperatorId> steps;
        if (!part.is_goal(start)) {
            HillClimbing climbing(part, labelled_, seed_);
            const Status status = climbing.run(monitor, few);
            if (status == Status::solved) {
                steps = climbing.plan();
            } else {
                LazySearch lazy(part, Preferred::helpful, labelled_, seed_, Ahead::bridged);
                if (monitor.stop() != Stop::none || lazy.run(monitor, few) != Status::solved) return std::nullopt;
                steps = lazy.plan();
            }
        }
        parts.push_back({order[i], steps, execute(question_.task, start, steps)});
    }
    return parts;
}

std::vector<OperatorId> GoalOrder::plan_of(const Parts& parts) {
    std::vector<OperatorId> plan;
    for (const Part& part : parts) plan.insert(plan.end(), part.steps.begin(), part.steps.end());
    return plan;
}

bool GoalOrder::improve(Monitor& monitor, Incumbent& best, bool shuffled) {
    std::vector<FactId> order = order_of(*best.plan);
    if (order.size() < 2) return monitor.stop() == Stop::none;
    if (shuffled) {
        ties_.shuffle(order);
        best.objective = dead_end;
    }
    auto parts = serialise(order, {}, 0, monitor);
    if (!parts) return monitor.stop() == Stop::none;
    Incumbent current{best.scorer, best.alpha, best.ratio, best.max_cost};
    current.offer(plan_of(*parts), question_);
    const std::size_t n = order.size();
    for (std::size_t tried = 0, move = 0; tried < n * n; ++tried, move = (move + 1) % (n * n)) {
        const std::size_t from = move / n, to = move % n;
        if (from == to || from == to + 1) continue;  // the latter: the same as the other way round
        std::vector<FactId> other = order;
        other.erase(other.begin() + static_cast<std::ptrdiff_t>(from));
        other.insert(other.begin() + static_cast<std::ptrdiff_t>(to), order[from]);
        auto moved = serialise(other, *parts, std::min(from, to), monitor);
        if (monitor.stop() != Stop::none) break;
        if (!moved || !current.offer(plan_of(*moved), question_)) continue;
        parts = std::move(moved);
        order = std::move(other);
        tried = 0;
    }
    if (current.plan) best.offer(*current.plan, question_);  // else each order costs more than a plan may
    return monitor.stop() == Stop::none;
}

}  // namespace explicable
