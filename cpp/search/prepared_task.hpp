// What all searches of one task share: made at first use, constant from then on, for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "search/relaxed_task.hpp"
#include "search/successors.hpp"

namespace explicable {

class PreparedTask {
public:
    explicit PreparedTask(const Task& task) : task_(task) {}

    const Task& task() const { return task_; }
    // About what the successors and one relaxed task take while they are made.
    std::size_t estimated_bytes() const {
        const std::size_t entries = task_.preconditions.values.size() + task_.adds.values.size() +
                                    task_.effect_conditions.values.size() + task_.effect_adds.values.size();
        const std::size_t rows = std::size_t(task_.num_operators()) + std::size_t(task_.effect_adds.size());
        return 24 * entries + 96 * rows;
    }
    const SuccessorGenerator& successors() const {
        return successors_.get([this] { return SuccessorGenerator(task_); });
    }
    // Merged.
    const RelaxedTask& relaxed(SupporterCost supporter_cost) const {
        return (supporter_cost == SupporterCost::unit ? relaxed_unit_ : relaxed_plus_one_).get([&] {
            RelaxedTask relaxed(task_, supporter_cost);
            relaxed.merge();
            return relaxed;
        });
    }
    // For each fact, the operators that need it, and those that add it: these repeated where several of their effects do.
    const Table<std::int32_t>& needing() const {
        return needing_.get([this] { return inverse(task_.preconditions, task_.num_facts()); });
    }
    const Table<std::int32_t>& achievers() const {
        return achievers_.get([this] {
            Table<FactId> adds;
            std::vector<FactId> added;
            for (OperatorId id = 0; id < task_.num_operators(); ++id) {
                added.assign(task_.adds[id].begin(), task_.adds[id].end());
                for (auto effect = task_.effect_offsets[id]; effect < task_.effect_offsets[id + 1]; ++effect) {
                    added.insert(added.end(), task_.effect_adds[effect].begin(), task_.effect_adds[effect].end());
                }
                adds.push_back(added);
            }
            return inverse(adds, task_.num_facts());
        });
    }

private:
    template <class T>
    class Once {
    public:
        template <class Make>
        const T& get(const Make& make) const {
            std::call_once(flag_, [&] { value_.emplace(make()); });
            return *value_;
        }

    private:
        mutable std::once_flag flag_;
        mutable std::optional<T> value_;
    };

    const Task& task_;
    Once<SuccessorGenerator> successors_;
    Once<RelaxedTask> relaxed_unit_, relaxed_plus_one_;
    Once<Table<std::int32_t>> needing_, achievers_;
};

}  // namespace explicable
