// A state as one value per finite-domain variable; the search packs it into bits when it stores it.
#pragma once

#include <cstdint>
#include <vector>

#include "task/task.hpp"

namespace explicable {

struct State {
    std::vector<std::int32_t> values;  // one a variable; 0 = none of its facts

    bool holds(const Task& task, FactId fact) const {
        return values[task.fact_variable[fact]] == task.fact_value[fact];
    }
};

}  // namespace explicable
