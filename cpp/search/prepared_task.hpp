// What all searches of one task share: made at first use, constant from then on, for any number of threads.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

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
};

}  // namespace explicable
