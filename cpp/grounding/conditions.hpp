// Ground conditions: a formula under a binding, in disjunctive normal form over facts.
#pragma once

#include <cstdint>
#include <new>
#include <string>
#include <vector>

#include "grounding/join.hpp"

namespace explicable::grounding {

using Literal = std::int32_t;  // 2 * fact, or 2 * fact + 1 if negated

inline Literal literal(FactId fact, bool negated) { return 2 * fact + (negated ? 1 : 0); }
inline FactId fact_of(Literal literal) { return literal >> 1; }
inline bool is_negated(Literal literal) { return literal & 1; }

using Conjunction = std::vector<Literal>;      // sorted, without contradiction
using Disjunction = std::vector<Conjunction>;  // empty: false; one empty conjunction: true

// The task is too large: bytes, entries of a table, or conjunctions of a normal form. An allocation failure by rank,
// so that a caller can treat all of them alike.
class TooLarge : public std::bad_alloc {
public:
    explicit TooLarge(std::string message) : message_(std::move(message)) {}
    const char* what() const noexcept override { return message_.c_str(); }

private:
    std::string message_;
};

// Sorts and removes doubles; false if a literal and its negation both stand there.
bool normalise(Conjunction& conjunction);

class ConditionGrounder {
public:
    ConditionGrounder(Database& database, Joiner& joiner) : database_(database), joiner_(joiner) {}

    // Plans the joins by which the quantifiers inside are enumerated, and puts what is cheap to refute first.
    void prepare(Formula& formula);
    // The same for the universally quantified variables of an effect.
    void prepare(LiftedEffect& effect);

    // binding: one object a variable; entries of quantified variables are overwritten.
    Disjunction ground(const Formula& formula, std::int32_t* binding);
    // The conjunction of literals already known and of formulas.
    Disjunction ground(const Conjunction& known, const std::vector<const Formula*>& formulas, std::int32_t* binding);

    const JoinPlan& join(std::int32_t number) const { return joins_[number]; }

private:
    Disjunction expand(const Formula& formula, std::int32_t* binding);
    std::int32_t add_join(const std::vector<std::int32_t>& domains, std::int32_t first_variable,
                          const Formula& body, bool body_must_hold);

    Database& database_;
    Joiner& joiner_;
    std::vector<JoinPlan> joins_;
    std::size_t num_expanded_ = 0;  // parts of the present condition, once for each binding of its quantifiers
};

}  // namespace explicable::grounding
