// From the lifted task to the grounded one.
#pragma once

#include <cstddef>
#include <functional>

#include "grounding/lifted.hpp"
#include "task/task.hpp"

namespace explicable::grounding {

// Throws TooLarge (a std::bad_alloc) beyond the memory limit. poll() is called every few milliseconds and may throw.
Task ground(LiftedTask& lifted, std::size_t memory_limit_bytes, const std::function<void()>& poll);

}  // namespace explicable::grounding
