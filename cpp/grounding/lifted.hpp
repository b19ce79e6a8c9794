// The lifted task in integers, as the Python side encodes it (model/encoding.py), and the reader of that encoding.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace explicable::grounding {

using Term = std::int32_t;  // a variable v >= 0, or the object ~term

// A formula in negation normal form: negation stands in literals and equalities only.
struct Formula {
    enum class Kind : std::uint8_t { literal, equality, conjunction, disjunction, exists, forall };
    Kind kind = Kind::conjunction;
    bool negated = false;
    std::int32_t predicate = -1;
    std::vector<Term> terms;
    std::vector<std::int32_t> domains;  // of the quantified variables, numbered from first_variable
    std::int32_t first_variable = 0;
    std::int32_t join = -1;  // how a quantifier's bindings are enumerated; filled in by the grounder
    std::vector<Formula> parts;

    bool is_true() const { return kind == Kind::conjunction && parts.empty(); }
};

struct LiftedEffect {
    std::vector<std::int32_t> domains;  // of the universally quantified variables
    std::int32_t first_variable = 0;
    std::int32_t join = -1;
    Formula condition;
    bool positive = true;
    std::int32_t predicate = 0;
    std::vector<Term> terms;

    bool is_simple() const { return domains.empty() && condition.is_true(); }
};

struct FunctionTerm {
    std::int32_t function = 0;
    std::vector<Term> terms;
};

struct Schema {
    std::vector<std::int32_t> domains;  // one a parameter
    Formula precondition;
    std::vector<LiftedEffect> effects;
    std::int32_t cost = 0;
    std::vector<FunctionTerm> cost_terms;
};

struct FunctionValues {
    std::int32_t arity = 0;
    std::span<const std::int32_t> arguments, values;
};

// The spans refer to the caller's arrays, which must outlive the task.
struct LiftedTask {
    std::int32_t num_objects = 0;
    std::int32_t num_variables = 0;  // the most that are ever in scope
    std::vector<std::vector<std::int32_t>> domains;
    std::vector<std::vector<std::uint8_t>> in_domain;  // [domain][object]
    std::vector<std::int32_t> arity;                   // of each predicate
    std::vector<std::uint8_t> fluent;                  // does any effect change the predicate?
    std::vector<std::span<const std::int32_t>> initial;  // arguments of the true atoms, predicate by predicate
    std::vector<std::int32_t> num_initial;
    std::vector<FunctionValues> functions;
    std::vector<Schema> schemas;
    Formula goal;
};

// Reads and checks an encoded task; throws std::invalid_argument where it is not one.
//
// structure: num_objects; the domains; the arities of the predicates; those of the functions; the schemas; the goal.
// Lists are preceded by their length.
LiftedTask read_lifted_task(std::span<const std::int32_t> structure,
                            const std::vector<std::span<const std::int32_t>>& initial,
                            const std::vector<std::int32_t>& num_initial,
                            const std::vector<std::span<const std::int32_t>>& function_arguments,
                            const std::vector<std::span<const std::int32_t>>& function_values);

}  // namespace explicable::grounding
