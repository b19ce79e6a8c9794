#include "search/relaxed_task.hpp"

#include <algorithm>

namespace explicable {

RelaxedTask::RelaxedTask(const Task& task, SupporterCost supporter_cost) {
    std::vector<FactId> conditions;
    for (OperatorId id = 0; id < task.num_operators(); ++id) {
        const auto own = task.preconditions[id];
        const std::int32_t own_cost =
            supporter_cost == SupporterCost::unit ? 1 : std::min(task.cost[id], max_operator_cost) + 1;
        const auto add_piece = [&](const auto& adds) {
            preconditions.push_back(conditions);
            this->adds.push_back(adds);
            owner.push_back(id);
            cost.push_back(own_cost);
        };
        const std::int32_t first = task.effect_offsets[id], last = task.effect_offsets[id + 1];
        if (first == last || !task.adds[id].empty()) {
            conditions.assign(own.begin(), own.end());
            add_piece(task.adds[id]);
        }
        for (std::int32_t effect = first; effect < last; ++effect) {
            if (task.effect_adds[effect].empty()) continue;
            conditions.assign(own.begin(), own.end());
            const auto more = task.effect_conditions[effect];
            conditions.insert(conditions.end(), more.begin(), more.end());
            std::sort(conditions.begin(), conditions.end());
            conditions.erase(std::unique(conditions.begin(), conditions.end()), conditions.end());
            add_piece(task.effect_adds[effect]);
        }
    }
    precondition_of = inverse(preconditions, task.num_facts());
    for (std::int32_t piece = 0; piece < size(); ++piece) {
        if (preconditions[piece].empty()) without_preconditions.push_back(piece);
    }
}

Table<std::int32_t> inverse(const Table<std::int32_t>& table, std::int32_t num_rows) {
    Table<std::int32_t> result;
    auto& offsets = result.offsets;
    offsets.assign(num_rows + 1, 0);
    for (const std::int32_t value : table.values) ++offsets[value + 1];
    for (std::int32_t row = 0; row < num_rows; ++row) offsets[row + 1] += offsets[row];
    result.values.resize(table.values.size());
    std::vector<std::int32_t> next(offsets.begin(), offsets.end() - 1);
    for (std::int32_t row = 0; row < table.size(); ++row) {
        for (const std::int32_t value : table[row]) result.values[next[value]++] = row;
    }
    return result;
}

}  // namespace explicable
