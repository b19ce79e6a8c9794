#include "search/plan_check.hpp"

#include <algorithm>
#include <vector>

namespace explicable {

std::optional<std::int64_t> execute_plan(const Task& task, const State& initial, std::span<const FactId> goal,
                                         std::span<const OperatorId> plan) {
    std::vector<bool> facts(task.num_facts());
    for (FactId fact = 0; fact < task.num_facts(); ++fact) facts[fact] = initial.holds(task, fact);
    const auto all_hold = [&facts](std::span<const FactId> needed) {
        return std::all_of(needed.begin(), needed.end(), [&facts](FactId fact) { return facts[fact]; });
    };
    std::int64_t cost = 0;
    for (const OperatorId step : plan) {
        if (!all_hold(task.preconditions[step])) return std::nullopt;
        cost += task.cost[step];
        std::vector<bool> next = facts;
        std::vector<FactId> added(task.adds[step].begin(), task.adds[step].end());
        for (const FactId fact : task.deletes[step]) next[fact] = false;
        for (std::int32_t effect = task.effect_offsets[step]; effect < task.effect_offsets[step + 1]; ++effect) {
            if (!all_hold(task.effect_conditions[effect])) continue;
            for (const FactId fact : task.effect_deletes[effect]) next[fact] = false;
            added.insert(added.end(), task.effect_adds[effect].begin(), task.effect_adds[effect].end());
        }
        for (const FactId fact : added) next[fact] = true;
        facts = std::move(next);
    }
    if (!all_hold(goal)) return std::nullopt;
    return cost;
}

}  // namespace explicable
