// Relaxed reachability: every operator and fact that the delete relaxation reaches, by semi-naive evaluation.
//
// A fact is processed once: it triggers the joins of the schemas whose precondition mentions its predicate, and
// these see processed facts only, so that each binding is found exactly once, by the last of its facts. What a join
// can't express (disjunctions, quantifiers) is grounded for each binding; operators and conditional effects that
// then lack facts wait for them, counting.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <set>
#include <vector>

#include "grounding/conditions.hpp"
#include "grounding/splitting.hpp"

namespace explicable::grounding {

// Ground operators before facts are renumbered. Not all of them need be reached.
struct RawOperators {
    Table<Literal> preconditions;
    Table<FactId> adds, deletes;
    std::vector<std::int32_t> cost, schema;
    Table<std::int32_t> arguments;
    std::vector<std::int32_t> effect_offsets{0};
    Table<Literal> effect_conditions;
    Table<FactId> effect_adds, effect_deletes;
    std::vector<std::uint8_t> reached;

    std::int32_t size() const { return preconditions.size(); }
    std::size_t memory_bytes() const;
};

class Exploration {
public:
    // The task is changed in that its conditions are put in order. poll() is called now and then; it may throw.
    Exploration(LiftedTask& task, std::size_t memory_limit_bytes, std::function<void()> poll);

    void run();
    Disjunction ground_goal();

    const Database& database() const { return database_; }
    RawOperators& operators() { return operators_; }

private:
    // A schema, or a variant of it, taken apart; slots number the fluent atoms among its conjuncts.
    struct Form {
        std::int32_t schema = 0;
        bool may_repeat = false;  // several bindings may lead to the same operator
        JoinQuery query;
        std::vector<std::int32_t> atom_of_slot;
        std::vector<JoinFilter> negative;       // fluent, negated: never in the way of the relaxation
        std::vector<const Formula*> conditions;  // to be grounded for each binding
        std::vector<std::int32_t> effect_slot;   // slot of the same atom, or -1
        bool has_conditional_effects = false;
    };
    struct Trigger {
        std::int32_t form;
        JoinPlan plan;
    };
    // An operator, or one of its conditional effects, that waits for facts.
    struct Rule {
        std::int32_t missing, op, effect;
    };

    void take_apart(std::int32_t schema, const Variant& variant, bool may_repeat);
    void plan_joins(std::int32_t form);
    void reach(FactId fact);
    void process(FactId fact);
    void instantiate(std::int32_t form);
    void add_operator(const Form& form, std::int32_t cost, const Conjunction& precondition);
    bool is_repeated(const Form& form, const Conjunction& precondition);
    void add_conditional_effects(const Form& form);
    bool wait(std::span<const Literal> condition, std::int32_t op, std::int32_t effect);
    void fire(std::int32_t op);
    void check_limits() const;
    FactId ground_atom(std::int32_t predicate, std::span<const Term> terms);
    std::int64_t ground_cost(const Schema& schema);

    LiftedTask& task_;
    Database database_;
    std::size_t memory_limit_bytes_;
    Joiner joiner_;
    ConditionGrounder conditions_;
    std::vector<std::vector<Variant>> variants_;  // by schema; the forms refer to their formulas
    std::vector<Form> forms_;
    std::vector<std::vector<Trigger>> triggers_;  // by predicate
    std::vector<Trigger> untriggered_;
    std::vector<Relation> function_rows_;

    RawOperators operators_;
    std::vector<FactId> queue_;
    std::vector<Rule> rules_;
    std::vector<std::vector<std::int32_t>> waiting_;  // rules by fact; shorter than the facts where none waits
    std::vector<std::int32_t> binding_, arguments_;
    std::vector<FactId> matched_, adds_, deletes_;
    std::set<std::vector<std::int32_t>> operators_seen_;  // of the forms that may repeat
};

}  // namespace explicable::grounding
