// Preconditions whose disjunctions and existential quantifiers must take part in the join.
#pragma once

#include <cstdint>
#include <vector>

#include "grounding/lifted.hpp"

namespace explicable::grounding {

// A precondition in part: a conjunction, over the parameters and over variables of its own.
struct Variant {
    std::vector<std::int32_t> variables, domains;  // of the existential quantifiers that were pulled out
    std::vector<Formula> conjuncts;
};

// Splits a precondition such that each parameter occurs in a positive literal where that can be had: else a parameter
// that only a disjunction or a quantifier restricts would be bound to every object of its type.
// Fresh variables are numbered from num_variables on, which is raised.
std::vector<Variant> split_precondition(const Schema& schema, std::int32_t& num_variables);

}  // namespace explicable::grounding
