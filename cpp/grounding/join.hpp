// Joins: all ways to bind variables so that atoms hold in the database. Plans are fixed once, then run many times.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "grounding/database.hpp"
#include "grounding/lifted.hpp"

namespace explicable::grounding {

// An atom to be matched. Fluent atoms note the fact that they matched in the slot.
struct JoinAtom {
    std::int32_t predicate = 0;
    std::span<const Term> terms;
    std::int32_t slot = -1;
    bool not_trigger = false;  // must match another fact than the one that triggered the join
};

// An equality, or a static atom that must (not) be there; checked as soon as its variables are bound.
struct JoinFilter {
    bool is_equality = false;
    bool negated = false;
    std::int32_t predicate = -1;
    std::span<const Term> terms;
};

struct JoinVariable {
    std::int32_t variable = 0;
    std::int32_t domain = 0;
};

struct JoinStep {
    enum class Kind : std::uint8_t { scan, lookup, enumerate, equality, absent };
    Kind kind = Kind::scan;
    bool negated = false;
    bool verify = false;  // the index bucket may hold rows of other keys
    bool not_trigger = false;
    std::int32_t predicate = -1;
    std::int32_t slot = -1;
    std::int32_t index = -1;
    std::vector<Term> terms;
    std::vector<std::int32_t> key_positions;
    std::vector<Term> key;
    struct Bind {
        std::int32_t position, variable, domain;  // domain -1: every object belongs to it
    };
    std::vector<Bind> binds;
    std::vector<std::pair<std::int32_t, std::int32_t>> same;  // positions that must hold the same object
};

struct JoinPlan {
    JoinStep trigger;  // binds variables from the fact that triggers the join, if there is one
    std::vector<JoinStep> steps;
};

struct JoinQuery {
    std::vector<JoinVariable> variables;  // to be bound
    std::vector<JoinAtom> atoms;
    std::vector<JoinFilter> filters;
};

// Orders the steps greedily by the expected number of matches; `trigger` is an index into the atoms or -1.
// Variables that are not among the query's are taken as bound.
JoinPlan plan_join(Database& database, const JoinQuery& query, std::int32_t trigger = -1);

class Joiner {
public:
    Joiner(const Database& database, std::function<void()> poll)
        : database_(database), poll_(std::move(poll)), scratch_(64) {}

    // Calls emit() for each way to complete `binding`; matched[slot] then holds the facts.
    template <class Emit>
    void run(const JoinPlan& plan, std::int32_t* binding, FactId* matched, Emit&& emit) {
        step(plan, 0, binding, matched, -1, emit);
    }
    // The same for the ways in which the plan's trigger atom matches the fact.
    template <class Emit>
    void run(const JoinPlan& plan, FactId trigger, std::int32_t* binding, FactId* matched, Emit&& emit) {
        if (!match(plan.trigger, database_.arguments_of(trigger), true, binding)) return;
        matched[plan.trigger.slot] = trigger;
        step(plan, 0, binding, matched, trigger, emit);
    }

    // Counts work, so that memory and interrupts are looked at now and then.
    void tick(std::size_t work = 1) {
        work_ += work;
        if (work_ < 65536) return;
        work_ = 0;
        poll_();
    }

private:
    static std::int32_t value(Term term, const std::int32_t* binding) { return term >= 0 ? binding[term] : ~term; }

    bool match(const JoinStep& step, const std::int32_t* row, bool verify, std::int32_t* binding) const {
        if (verify)
            for (std::size_t i = 0; i < step.key.size(); ++i)
                if (row[step.key_positions[i]] != value(step.key[i], binding)) return false;
        for (const auto& [first, second] : step.same)
            if (row[first] != row[second]) return false;
        for (const auto& bind : step.binds) {
            const std::int32_t object = row[bind.position];
            if (bind.domain >= 0 && !database_.task().in_domain[bind.domain][object]) return false;
            binding[bind.variable] = object;
        }
        return true;
    }
    RowId find(const JoinStep& step, const std::int32_t* binding) {
        if (scratch_.size() < step.terms.size()) scratch_.resize(step.terms.size());
        for (std::size_t i = 0; i < step.terms.size(); ++i) scratch_[i] = value(step.terms[i], binding);
        return database_.relation(step.predicate).find(scratch_.data());
    }
    // Whether a row may stand for the atom of a step, noted in its slot.
    bool admit(const JoinStep& step, RowId row, FactId* matched, FactId trigger) const {
        if (step.slot < 0) return true;
        const FactId fact = database_.fact_of(step.predicate, row);
        if (!database_.is_processed(fact) || (step.not_trigger && fact == trigger)) return false;
        matched[step.slot] = fact;
        return true;
    }

    template <class Emit>
    void step(const JoinPlan& plan, std::size_t depth, std::int32_t* binding, FactId* matched, FactId trigger,
              Emit& emit) {
        if (depth == plan.steps.size()) {
            emit();
            return;
        }
        const JoinStep& now = plan.steps[depth];
        switch (now.kind) {
            case JoinStep::Kind::scan: {
                if (scratch_.size() < now.key.size()) scratch_.resize(now.key.size());
                for (std::size_t i = 0; i < now.key.size(); ++i) scratch_[i] = value(now.key[i], binding);
                const Relation& relation = database_.relation(now.predicate);
                const Index& index = relation.index(now.index);
                for (RowId row = relation.first(index, scratch_.data()); row >= 0; row = index.next[row]) {
                    tick();
                    if (match(now, relation.row(row), now.verify, binding) && admit(now, row, matched, trigger))
                        step(plan, depth + 1, binding, matched, trigger, emit);
                }
                return;
            }
            case JoinStep::Kind::lookup: {
                const RowId row = find(now, binding);
                if (row >= 0 && admit(now, row, matched, trigger))
                    step(plan, depth + 1, binding, matched, trigger, emit);
                return;
            }
            case JoinStep::Kind::enumerate:
                for (const std::int32_t object : database_.task().domains[now.binds[0].domain]) {
                    tick();
                    binding[now.binds[0].variable] = object;
                    step(plan, depth + 1, binding, matched, trigger, emit);
                }
                return;
            case JoinStep::Kind::equality:
                if ((value(now.terms[0], binding) == value(now.terms[1], binding)) != now.negated)
                    step(plan, depth + 1, binding, matched, trigger, emit);
                return;
            case JoinStep::Kind::absent:
                if (find(now, binding) < 0) step(plan, depth + 1, binding, matched, trigger, emit);
                return;
        }
    }

    const Database& database_;
    std::function<void()> poll_;
    std::vector<std::int32_t> scratch_;
    std::size_t work_ = 0;
};

}  // namespace explicable::grounding
