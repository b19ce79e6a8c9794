// What an operator does to a state: conditions are read in the old state, deletes come before adds.
#pragma once

#include <vector>

#include "task/packed_state.hpp"
#include "task/task.hpp"

namespace explicable {

// Writes the successor to `to`, which must not overlap `from`.
inline void apply(const Task& task, const StatePacker& packer, OperatorId op, const Word* from, Word* to) {
    std::copy_n(from, packer.num_words(), to);
    auto fires = [&](std::int32_t effect) {
        const auto condition = task.effect_conditions[effect];
        return std::all_of(condition.begin(), condition.end(), [&](FactId fact) { return packer.holds(from, fact); });
    };
    const std::int32_t first = task.effect_offsets[op], last = task.effect_offsets[op + 1];
    for (const FactId fact : task.deletes[op]) packer.remove(to, fact);
    for (std::int32_t effect = first; effect < last; ++effect)
        if (fires(effect))
            for (const FactId fact : task.effect_deletes[effect]) packer.remove(to, fact);
    for (const FactId fact : task.adds[op]) packer.add(to, fact);
    for (std::int32_t effect = first; effect < last; ++effect)
        if (fires(effect))
            for (const FactId fact : task.effect_adds[effect]) packer.add(to, fact);
}

}  // namespace explicable
