#include "search/relaxed_task.hpp"

#include <algorithm>
#include <bit>
#include <tuple>

namespace explicable {

namespace {

constexpr std::size_t most_subset_facts = 4;  // preconditions up to which all subsets are looked for

// Numbers rows of facts, with a cost each, in the order of their first appearance.
class RowNumbers {
public:
    explicit RowNumbers(std::int32_t capacity) : slots_(std::bit_ceil(static_cast<std::size_t>(capacity) * 2 + 2), -1) {}

    std::int32_t number(std::span<const FactId> row, std::int32_t cost) {
        std::int32_t& slot = slots_[find(row, cost)];
        if (slot < 0) {
            slot = rows.size();
            rows.push_back(row);
            costs.push_back(cost);
        }
        return slot;
    }
    // -1 if there is none.
    std::int32_t look_up(std::span<const FactId> row, std::int32_t cost) const { return slots_[find(row, cost)]; }

    Table<FactId> rows;
    std::vector<std::int32_t> costs;

private:
    std::vector<std::int32_t> slots_;

    std::size_t find(std::span<const FactId> row, std::int32_t cost) const {
        std::uint64_t hash = static_cast<std::uint32_t>(cost) + 1;
        for (const FactId fact : row) {
            hash = (hash ^ static_cast<std::uint32_t>(fact)) * 0x9e3779b97f4a7c15ULL;
            hash ^= hash >> 29;
        }
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = hash & mask;
        while (slots_[at] >= 0 && !(costs[slots_[at]] == cost && std::ranges::equal(rows[slots_[at]], row))) {
            at = (at + 1) & mask;
        }
        return at;
    }
};

struct Add {
    std::int32_t piece;
    FactId fact;
    OperatorId owner;
    auto operator<=>(const Add&) const = default;
};

}  // namespace

RelaxedTask::RelaxedTask(const Task& task, SupporterCost supporter_cost) {
    for (OperatorId id = 0; id < task.num_operators(); ++id) {
        const auto own = task.preconditions[id];
        const std::int32_t own_cost =
            supporter_cost == SupporterCost::unit ? 1 : std::min(task.cost[id], max_operator_cost) + 1;
        const std::int32_t first = task.effect_offsets[id], last = task.effect_offsets[id + 1];
        if (first == last || !task.adds[id].empty()) add_piece({own.begin(), own.end()}, task.adds[id], id, own_cost);
        for (std::int32_t effect = first; effect < last; ++effect) {
            if (task.effect_adds[effect].empty()) continue;
            std::vector<FactId> needed(own.begin(), own.end());
            const auto more = task.effect_conditions[effect];
            needed.insert(needed.end(), more.begin(), more.end());
            std::sort(needed.begin(), needed.end());
            needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
            add_piece(std::move(needed), task.effect_adds[effect], id, own_cost);
        }
    }
    index(task.num_facts());
}

void RelaxedTask::add_piece(std::vector<FactId> needed, std::span<const FactId> added, OperatorId id,
                            std::int32_t piece_cost) {
    piece_of.insert(piece_of.end(), added.size(), size());
    owner.insert(owner.end(), added.size(), id);
    preconditions.push_back(needed);
    adds.push_back(added);
    cost.push_back(piece_cost);
}

void RelaxedTask::index(std::int32_t num_facts) {
    precondition_of = inverse(preconditions, num_facts);
    without_preconditions.clear();
    for (std::int32_t piece = 0; piece < size(); ++piece) {
        if (preconditions[piece].empty()) without_preconditions.push_back(piece);
    }
}

void RelaxedTask::merge() {
    const std::int32_t num_facts = precondition_of.size();
    RowNumbers groups(size());
    std::vector<Add> merged;
    merged.reserve(adds.values.size());
    for (std::int32_t piece = 0; piece < size(); ++piece) {
        const auto needed = preconditions[piece];
        const std::int32_t group = groups.number(needed, cost[piece]);
        for (std::int32_t i = adds.offsets[piece]; i < adds.offsets[piece + 1]; ++i) {
            const FactId fact = adds.values[i];
            if (!std::binary_search(needed.begin(), needed.end(), fact)) merged.push_back({group, fact, owner[i]});
        }
    }
    std::sort(merged.begin(), merged.end());
    // Of several owners of one add, the first one stays.
    merged.erase(std::unique(merged.begin(), merged.end(),
                             [](const Add& a, const Add& b) { return a.piece == b.piece && a.fact == b.fact; }),
                 merged.end());
    std::vector<std::int32_t> begin(groups.rows.size() + 1, 0);
    for (const Add& add : merged) ++begin[add.piece + 1];
    for (std::int32_t group = 0; group < groups.rows.size(); ++group) begin[group + 1] += begin[group];
    const auto adds_fact = [&](std::int32_t group, FactId fact) {
        const auto first = merged.begin() + begin[group], last = merged.begin() + begin[group + 1];
        const auto found = std::lower_bound(first, last, fact, [](const Add& add, FactId f) { return add.fact < f; });
        return found != last && found->fact == fact;
    };

    preconditions = {};
    adds = {};
    owner.clear();
    piece_of.clear();
    cost.clear();
    std::vector<FactId> subset, kept;
    std::vector<OperatorId> kept_owners;
    std::vector<std::int32_t> dominators;
    for (std::int32_t group = 0; group < groups.rows.size(); ++group) {
        const auto needed = groups.rows[group];
        dominators.clear();
        if (needed.size() <= most_subset_facts) {
            for (std::uint32_t chosen = 0; chosen + 1 < 1U << needed.size(); ++chosen) {
                subset.clear();
                for (std::size_t i = 0; i < needed.size(); ++i) {
                    if (chosen >> i & 1) subset.push_back(needed[i]);
                }
                const std::int32_t found = groups.look_up(subset, groups.costs[group]);
                if (found >= 0) dominators.push_back(found);
            }
        }
        kept.clear();
        kept_owners.clear();
        for (std::int32_t i = begin[group]; i < begin[group + 1]; ++i) {
            const FactId fact = merged[i].fact;
            if (std::any_of(dominators.begin(), dominators.end(), [&](auto other) { return adds_fact(other, fact); })) continue;
            kept.push_back(fact);
            kept_owners.push_back(merged[i].owner);
        }
        if (kept.empty()) continue;
        piece_of.insert(piece_of.end(), kept.size(), size());
        owner.insert(owner.end(), kept_owners.begin(), kept_owners.end());
        preconditions.push_back(needed);
        adds.push_back(kept);
        cost.push_back(groups.costs[group]);
    }
    index(num_facts);
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
