// From what the exploration reached to the finished task: constants left out, negation compiled away.
#pragma once

#include "grounding/exploration.hpp"
#include "task/task.hpp"

namespace explicable::grounding {

// All of the task but its finite-domain variables. The operators are consumed.
Task assemble(const Database& database, RawOperators& operators, Disjunction goal);

}  // namespace explicable::grounding
