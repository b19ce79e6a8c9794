#include "grounding/assembly.hpp"

#include <algorithm>

namespace explicable::grounding {
namespace {

using Facts = std::vector<FactId>;

bool contains(const Facts& sorted, FactId fact) { return std::binary_search(sorted.begin(), sorted.end(), fact); }

void sort_unique(std::vector<std::int32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

struct GroundEffect {
    Conjunction condition;
    Facts adds, deletes;
};

// One operator in the numbering of the database, simplified: a fact that is added is not deleted.
struct GroundOperator {
    Conjunction precondition;
    Facts adds, deletes;
    std::vector<GroundEffect> effects;
};

class Assembler {
public:
    Assembler(const Database& database, RawOperators& raw) : database_(database), raw_(raw) {}

    Task assemble(Disjunction goal) {
        find_constants();
        simplify_goal(goal);
        for (const Conjunction& conjunction : goal) demand_complements(conjunction);
        GroundOperator op;
        for (OperatorId o = 0; o < raw_.size(); ++o)
            if (simplify(o, op)) {
                demand_complements(op.precondition);
                for (const GroundEffect& effect : op.effects) demand_complements(effect.condition);
            }
        close_demand();
        number_facts();
        for (OperatorId o = 0; o < raw_.size(); ++o)
            if (simplify(o, op)) add_operator(o, op);
        set_goal(goal);
        return std::move(task_);
    }

private:
    bool may_hold(const Conjunction& condition) const {
        return std::all_of(condition.begin(), condition.end(), [&](Literal l) {
            return is_negated(l) ? !always_[fact_of(l)] : database_.is_reached(fact_of(l));
        });
    }
    // Leaves out literals that hold in every reachable state; false if one holds in none.
    bool simplify(Conjunction& condition) const {
        if (!may_hold(condition)) return false;
        std::erase_if(condition, [&](Literal l) {
            return is_negated(l) ? !database_.is_reached(fact_of(l)) : always_[fact_of(l)] != 0;
        });
        return true;
    }

    // A fact is always true if it is true at the start and nothing deletes it.
    void find_constants() {
        always_.assign(database_.num_facts(), 0);
        std::fill_n(always_.begin(), database_.num_initial(), 1);
        for (OperatorId o = 0; o < raw_.size(); ++o) {
            if (!raw_.reached[o]) continue;
            const auto adds = raw_.adds[o];
            for (const FactId fact : raw_.deletes[o])
                if (std::find(adds.begin(), adds.end(), fact) == adds.end()) always_[fact] = 0;
            for (std::int32_t e = raw_.effect_offsets[o]; e < raw_.effect_offsets[o + 1]; ++e)
                for (const FactId fact : raw_.effect_deletes[e]) always_[fact] = 0;
        }
    }

    // False if the operator can't be applied, or changes nothing.
    bool simplify(OperatorId o, GroundOperator& op) const {
        if (!raw_.reached[o]) return false;
        const auto precondition = raw_.preconditions[o];
        op.precondition.assign(precondition.begin(), precondition.end());
        if (!simplify(op.precondition)) return false;
        const auto adds = raw_.adds[o];
        op.adds.assign(adds.begin(), adds.end());
        sort_unique(op.adds);
        const auto deletes = raw_.deletes[o];
        op.deletes.assign(deletes.begin(), deletes.end());
        sort_unique(op.deletes);
        std::erase_if(op.deletes, [&](FactId f) { return !database_.is_reached(f); });
        op.effects.clear();
        for (std::int32_t e = raw_.effect_offsets[o]; e < raw_.effect_offsets[o + 1]; ++e) add_effect(e, op);
        const bool changes_nothing = op.adds.empty() && op.deletes.empty() && op.effects.empty();
        std::erase_if(op.deletes, [&](FactId f) { return contains(op.adds, f); });
        for (GroundEffect& effect : op.effects) {
            std::erase_if(effect.adds, [&](FactId f) { return contains(op.adds, f); });
            std::erase_if(effect.deletes, [&](FactId f) { return contains(op.adds, f) || contains(effect.adds, f); });
        }
        std::erase_if(op.adds, [&](FactId f) { return always_[f]; });
        return !changes_nothing;
    }
    // A conditional effect, or more unconditional ones if the precondition implies the condition.
    void add_effect(std::int32_t e, GroundOperator& op) const {
        GroundEffect effect;
        effect.condition.assign(raw_.effect_conditions[e].begin(), raw_.effect_conditions[e].end());
        if (!simplify(effect.condition)) return;
        const Conjunction& known = op.precondition;
        std::erase_if(effect.condition, [&](Literal l) { return std::binary_search(known.begin(), known.end(), l); });
        if (std::any_of(effect.condition.begin(), effect.condition.end(),
                        [&](Literal l) { return std::binary_search(known.begin(), known.end(), l ^ 1); }))
            return;
        effect.adds.assign(raw_.effect_adds[e].begin(), raw_.effect_adds[e].end());
        effect.deletes.assign(raw_.effect_deletes[e].begin(), raw_.effect_deletes[e].end());
        std::erase_if(effect.adds, [&](FactId f) { return always_[f]; });
        std::erase_if(effect.deletes, [&](FactId f) { return !database_.is_reached(f); });
        if (effect.condition.empty()) {
            op.adds.insert(op.adds.end(), effect.adds.begin(), effect.adds.end());
            op.deletes.insert(op.deletes.end(), effect.deletes.begin(), effect.deletes.end());
            sort_unique(op.adds);
            sort_unique(op.deletes);
        } else if (!effect.adds.empty() || !effect.deletes.empty()) {
            op.effects.push_back(std::move(effect));
        }
    }

    void demand_complements(const Conjunction& condition) {
        complement_.resize(database_.num_facts(), -1);
        for (const Literal l : condition)
            if (is_negated(l)) complement_[fact_of(l)] = 0;
    }
    // The complement of a fact that one operator deletes and, under a condition, adds becomes true only where
    // the condition fails: so the negation of the condition is needed too.
    void close_demand() {
        GroundOperator op;
        for (bool changed = true; changed;) {
            changed = false;
            for (OperatorId o = 0; o < raw_.size(); ++o) {
                if (raw_.effect_offsets[o] == raw_.effect_offsets[o + 1] || !simplify(o, op)) continue;
                for (const GroundEffect& adder : op.effects)
                    for (const FactId fact : adder.adds) {
                        if (complement_[fact] < 0 || !is_deleted(op, fact)) continue;
                        for (const Literal l : adder.condition)
                            if (!is_negated(l) && complement_[fact_of(l)] < 0) {
                                complement_[fact_of(l)] = 0;
                                changed = true;
                            }
                    }
            }
        }
    }
    static bool is_deleted(const GroundOperator& op, FactId fact) {
        return contains(op.deletes, fact) ||
               std::any_of(op.effects.begin(), op.effects.end(),
                           [&](const GroundEffect& effect) { return contains(effect.deletes, fact); });
    }

    void number_facts() {
        complement_.resize(database_.num_facts(), -1);
        number_.assign(database_.num_facts(), -1);
        FactId next = 0;
        auto enter = [&](FactId fact, bool negated) {
            const std::int32_t predicate = database_.predicate_of(fact);
            task_.fact_predicate.push_back(negated ? ~predicate : predicate);
            const std::int32_t* arguments = database_.arguments_of(fact);
            task_.fact_arguments.push_back(std::span(arguments, database_.relation(predicate).arity()));
            if ((fact < database_.num_initial()) != negated) task_.initial.push_back(next);
            return next++;
        };
        for (FactId fact = 0; fact < database_.num_facts(); ++fact)
            if (database_.is_reached(fact) && !always_[fact]) number_[fact] = enter(fact, false);
        for (FactId fact = 0; fact < database_.num_facts(); ++fact)
            if (complement_[fact] >= 0) complement_[fact] = enter(fact, true);
    }

    Facts number(const Conjunction& condition) const {
        Facts facts;
        for (const Literal l : condition) facts.push_back(is_negated(l) ? complement_[fact_of(l)] : number_[fact_of(l)]);
        std::sort(facts.begin(), facts.end());
        return facts;
    }

    void add_operator(OperatorId o, GroundOperator& op) {
        const Facts precondition = number(op.precondition);
        if (is_double(o, precondition)) return;
        std::vector<GroundEffect> extra;
        Facts adds, deletes;
        renumber(op.adds, op.deletes, {}, nullptr, op, adds, deletes, extra);
        task_.preconditions.push_back(precondition);
        task_.adds.push_back(adds);
        task_.deletes.push_back(deletes);
        task_.cost.push_back(raw_.cost[o]);
        task_.operator_schema.push_back(raw_.schema[o]);
        task_.operator_arguments.push_back(raw_.arguments[o]);
        for (const GroundEffect& effect : op.effects) {
            renumber(effect.adds, effect.deletes, effect.condition, &effect, op, adds, deletes, extra);
            if (!adds.empty() || !deletes.empty()) add_effect(effect.condition, adds, deletes);
        }
        for (const GroundEffect& effect : extra) add_effect(effect.condition, effect.adds, effect.deletes);
        task_.effect_offsets.push_back(task_.effect_conditions.size());
    }
    void add_effect(const Conjunction& condition, const Facts& adds, const Facts& deletes) {
        task_.effect_conditions.push_back(number(condition));
        task_.effect_adds.push_back(adds);
        task_.effect_deletes.push_back(deletes);
    }
    // Has a disjunct of the same action already led to this precondition?
    bool is_double(OperatorId o, const Facts& precondition) const {
        for (OperatorId other = task_.num_operators() - 1; other >= 0; --other) {
            if (task_.operator_schema[other] != raw_.schema[o] ||
                !std::ranges::equal(task_.operator_arguments[other], raw_.arguments[o]))
                return false;
            if (std::ranges::equal(task_.preconditions[other], precondition)) return true;
        }
        return false;
    }

    // The task's numbers of what is added and deleted, complements included. Where some other effect of the operator
    // may add what is deleted here, the complement goes to an extra effect under a stronger condition.
    void renumber(const Facts& from_adds, const Facts& from_deletes, const Conjunction& condition,
                  const GroundEffect* self, const GroundOperator& op, Facts& adds, Facts& deletes,
                  std::vector<GroundEffect>& extra) const {
        adds.clear();
        deletes.clear();
        for (const FactId fact : from_adds) {
            adds.push_back(number_[fact]);
            if (complement_[fact] >= 0) deletes.push_back(complement_[fact]);
        }
        for (const FactId fact : from_deletes) {
            deletes.push_back(number_[fact]);
            if (complement_[fact] < 0) continue;
            Disjunction unless{condition};
            for (const GroundEffect& adder : op.effects)
                if (&adder != self && contains(adder.adds, fact)) unless = conjoin_negation(unless, adder.condition);
            if (unless.size() == 1 && unless[0] == condition)
                adds.push_back(complement_[fact]);
            else
                for (Conjunction& conjunction : unless) extra.push_back({std::move(conjunction), {complement_[fact]}, {}});
        }
        std::erase(deletes, -1);
        std::sort(adds.begin(), adds.end());
        std::sort(deletes.begin(), deletes.end());
    }
    static Disjunction conjoin_negation(const Disjunction& disjunction, const Conjunction& negated) {
        Disjunction result;
        for (const Conjunction& conjunction : disjunction)
            for (const Literal l : negated) {
                Conjunction both = conjunction;
                both.push_back(l ^ 1);
                if (normalise(both)) result.push_back(std::move(both));
                if (result.size() > 4096) throw TooLarge("conditional effects split into more than 4096 effects");
            }
        std::sort(result.begin(), result.end());
        result.erase(std::unique(result.begin(), result.end()), result.end());
        return result;
    }

    void simplify_goal(Disjunction& goal) const {
        std::erase_if(goal, [&](Conjunction& conjunction) { return !simplify(conjunction); });
        if (std::any_of(goal.begin(), goal.end(), [](const Conjunction& c) { return c.empty(); })) goal = {{}};
        std::sort(goal.begin(), goal.end());
        goal.erase(std::unique(goal.begin(), goal.end()), goal.end());
    }
    void set_goal(const Disjunction& goal) {
        task_.goal_reachable = !goal.empty();
        if (goal.size() == 1) task_.goal = number(goal[0]);
        if (goal.size() < 2) return;
        const auto achieved = static_cast<FactId>(task_.fact_predicate.size());
        task_.fact_predicate.push_back(auxiliary);
        task_.fact_arguments.push_back(Facts{});
        task_.goal = {achieved};
        for (const Conjunction& conjunction : goal) {
            task_.preconditions.push_back(number(conjunction));
            task_.adds.push_back(Facts{achieved});
            task_.deletes.push_back(Facts{});
            task_.cost.push_back(0);
            task_.operator_schema.push_back(auxiliary);
            task_.operator_arguments.push_back(Facts{});
            task_.effect_offsets.push_back(task_.effect_conditions.size());
        }
    }

    const Database& database_;
    RawOperators& raw_;
    std::vector<std::uint8_t> always_;
    std::vector<FactId> number_;      // in the task, or -1
    std::vector<FactId> complement_;  // number of the negated fact, or -1 if no condition asks for it
    Task task_;
};

}  // namespace

Task assemble(const Database& database, RawOperators& operators, Disjunction goal) {
    return Assembler(database, operators).assemble(std::move(goal));
}

}  // namespace explicable::grounding
