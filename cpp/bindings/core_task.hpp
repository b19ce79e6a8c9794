// What Python knows as _core.Task: the task with the structures that its methods need. A function that takes a
// `const Task&` accepts it as well.
#pragma once

#include <utility>

#include "search/prepared_task.hpp"
#include "search/way_finder.hpp"
#include "task/packed_state.hpp"
#include "task/task.hpp"
#include "task/task_index.hpp"

namespace explicable {

struct CoreTask : Task {
    explicit CoreTask(Task&& task) : Task(std::move(task)), packer(*this), index(*this), prepared(*this), ways(prepared, packer) {}
    CoreTask(const CoreTask&) = delete;

    StatePacker packer;
    TaskIndex index;
    PreparedTask prepared;
    mutable WayFinder ways;
};

}  // namespace explicable
