#include "grounding/exploration.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace explicable::grounding {

std::size_t RawOperators::memory_bytes() const {
    auto bytes = [](const auto& table) { return 4 * (table.offsets.capacity() + table.values.capacity()); };
    return bytes(preconditions) + bytes(adds) + bytes(deletes) + bytes(arguments) + bytes(effect_conditions) +
           bytes(effect_adds) + bytes(effect_deletes) +
           4 * (cost.capacity() + schema.capacity() + effect_offsets.capacity()) + reached.capacity();
}

Exploration::Exploration(LiftedTask& task, std::size_t memory_limit_bytes, std::function<void()> poll)
    : task_(task),
      database_(task),
      memory_limit_bytes_(memory_limit_bytes),
      joiner_(database_,
              [this, poll = std::move(poll)] {
                  check_limits();
                  poll();
              }),
      conditions_(database_, joiner_),
      triggers_(task.arity.size()) {
    for (std::size_t s = 0; s < task.schemas.size(); ++s)
        variants_.push_back(split_precondition(task.schemas[s], task.num_variables));
    for (std::size_t s = 0; s < task.schemas.size(); ++s) {
        for (LiftedEffect& effect : task.schemas[s].effects)
            if (!effect.is_simple()) conditions_.prepare(effect);
        for (Variant& variant : variants_[s]) {
            for (Formula& part : variant.conjuncts) conditions_.prepare(part);
            take_apart(static_cast<std::int32_t>(s), variant,
                       variants_[s].size() > 1 || !variant.variables.empty());
        }
    }
    conditions_.prepare(task.goal);
    binding_.resize(task.num_variables);
    for (std::size_t form = 0; form < forms_.size(); ++form) plan_joins(static_cast<std::int32_t>(form));
    for (const FunctionValues& function : task.functions) {
        Relation& rows = function_rows_.emplace_back(function.arity, task.num_objects);
        for (std::size_t i = 0; i < function.values.size(); ++i)
            if (!rows.insert(function.arguments.data() + i * function.arity).second)
                throw std::invalid_argument("encoded task: a function has two values");
    }
    database_.index_static_rows();
}

void Exploration::plan_joins(std::int32_t number) {
    Form& form = forms_[number];
    const auto num_slots = static_cast<std::int32_t>(form.atom_of_slot.size());
    if (std::ssize(matched_) < num_slots) matched_.resize(num_slots);
    if (num_slots == 0) untriggered_.push_back({number, plan_join(database_, form.query)});
    for (std::int32_t slot = 0; slot < num_slots; ++slot) {
        const std::int32_t atom = form.atom_of_slot[slot];
        for (JoinAtom& other : form.query.atoms) other.not_trigger = other.slot >= 0 && other.slot < slot;
        triggers_[form.query.atoms[atom].predicate].push_back({number, plan_join(database_, form.query, atom)});
    }
}

void Exploration::take_apart(std::int32_t number, const Variant& variant, bool may_repeat) {
    const Schema& schema = task_.schemas[number];
    Form& form = forms_.emplace_back();
    form.schema = number;
    form.may_repeat = may_repeat;
    for (std::size_t i = 0; i < schema.domains.size(); ++i)
        form.query.variables.push_back({static_cast<std::int32_t>(i), schema.domains[i]});
    for (std::size_t i = 0; i < variant.variables.size(); ++i)
        form.query.variables.push_back({variant.variables[i], variant.domains[i]});
    auto take_conjunct = [&](const Formula& part) {
        if (part.kind == Formula::Kind::equality) {
            form.query.filters.push_back({true, part.negated, -1, part.terms});
        } else if (part.kind != Formula::Kind::literal) {
            form.conditions.push_back(&part);
        } else if (part.negated) {
            auto& filters = database_.is_fluent(part.predicate) ? form.negative : form.query.filters;
            filters.push_back({false, true, part.predicate, part.terms});
        } else {
            const bool fluent = database_.is_fluent(part.predicate);
            const auto slot = static_cast<std::int32_t>(fluent ? form.atom_of_slot.size() : -1);
            if (fluent) form.atom_of_slot.push_back(static_cast<std::int32_t>(form.query.atoms.size()));
            form.query.atoms.push_back({part.predicate, part.terms, slot, false});
        }
    };
    for (const Formula& part : variant.conjuncts) take_conjunct(part);

    for (const LiftedEffect& effect : schema.effects) {
        form.has_conditional_effects = form.has_conditional_effects || !effect.is_simple();
        std::int32_t slot = -1;
        for (const JoinAtom& atom : form.query.atoms)
            if (atom.slot >= 0 && atom.predicate == effect.predicate && effect.is_simple() &&
                std::equal(atom.terms.begin(), atom.terms.end(), effect.terms.begin()))
                slot = atom.slot;
        form.effect_slot.push_back(slot);
    }
}

void Exploration::run() {
    for (FactId fact = 0; fact < database_.num_initial(); ++fact) reach(fact);
    for (const Trigger& trigger : untriggered_)
        joiner_.run(trigger.plan, binding_.data(), matched_.data(), [&] { instantiate(trigger.form); });
    for (std::size_t next = 0; next < queue_.size(); ++next) process(queue_[next]);
    check_limits();
}

Disjunction Exploration::ground_goal() { return conditions_.ground(task_.goal, binding_.data()); }

void Exploration::reach(FactId fact) {
    if (database_.is_reached(fact)) return;
    database_.mark_reached(fact);
    queue_.push_back(fact);
}

void Exploration::process(FactId fact) {
    joiner_.tick();
    database_.mark_processed(fact);
    for (const Trigger& trigger : triggers_[database_.predicate_of(fact)])
        joiner_.run(trigger.plan, fact, binding_.data(), matched_.data(), [&] { instantiate(trigger.form); });
    if (std::size_t(fact) >= waiting_.size()) return;
    const auto waiting = std::exchange(waiting_[fact], {});
    for (const std::int32_t number : waiting) {
        Rule& rule = rules_[number];
        if (--rule.missing > 0) continue;
        if (rule.effect < 0)
            fire(rule.op);
        else
            for (const FactId add : operators_.effect_adds[rule.effect]) reach(add);
    }
}

FactId Exploration::ground_atom(std::int32_t predicate, std::span<const Term> terms) {
    arguments_.clear();
    for (const Term term : terms) arguments_.push_back(term >= 0 ? binding_[term] : ~term);
    return database_.intern(predicate, arguments_.data());
}

// -1 if a number in it is undefined: then the action can't be applied.
std::int64_t Exploration::ground_cost(const Schema& schema) {
    std::int64_t cost = schema.cost;
    for (const FunctionTerm& term : schema.cost_terms) {
        arguments_.clear();
        for (const Term t : term.terms) arguments_.push_back(t >= 0 ? binding_[t] : ~t);
        const RowId row = function_rows_[term.function].find(arguments_.data());
        if (row < 0) return -1;
        cost += task_.functions[term.function].values[row];
    }
    if (cost > std::numeric_limits<std::int32_t>::max()) throw TooLarge("an action costs more than 2147483647");
    return cost;
}

// One operator for each conjunction that the precondition amounts to under the present binding.
void Exploration::instantiate(std::int32_t number) {
    joiner_.tick();
    const Form& form = forms_[number];
    const Schema& schema = task_.schemas[form.schema];
    const std::int64_t cost = ground_cost(schema);
    if (cost < 0) return;

    Conjunction precondition;
    for (std::size_t slot = 0; slot < form.atom_of_slot.size(); ++slot)
        precondition.push_back(literal(matched_[slot], false));
    for (const JoinFilter& negative : form.negative)
        precondition.push_back(literal(ground_atom(negative.predicate, negative.terms), true));
    if (!normalise(precondition)) return;

    adds_.clear();
    deletes_.clear();
    for (std::size_t i = 0; i < schema.effects.size(); ++i) {
        const LiftedEffect& effect = schema.effects[i];
        if (!effect.is_simple()) continue;
        const std::int32_t slot = form.effect_slot[i];
        const FactId fact = slot >= 0 ? matched_[slot] : ground_atom(effect.predicate, effect.terms);
        (effect.positive ? adds_ : deletes_).push_back(fact);
    }

    if (form.conditions.empty()) {
        add_operator(form, static_cast<std::int32_t>(cost), precondition);
        return;
    }
    for (const Conjunction& conjunction : conditions_.ground(precondition, form.conditions, binding_.data()))
        add_operator(form, static_cast<std::int32_t>(cost), conjunction);
}

void Exploration::add_operator(const Form& form, std::int32_t cost, const Conjunction& precondition) {
    joiner_.tick(precondition.size());
    if (form.may_repeat && is_repeated(form, precondition)) return;
    const std::int32_t op = operators_.size();
    const auto num_parameters = task_.schemas[form.schema].domains.size();
    operators_.preconditions.push_back(precondition);
    operators_.cost.push_back(cost);
    operators_.schema.push_back(form.schema);
    operators_.arguments.push_back(std::span(binding_.data(), num_parameters));
    operators_.reached.push_back(0);
    if (form.has_conditional_effects) {
        const std::vector<FactId> simple_adds = adds_, simple_deletes = deletes_;
        add_conditional_effects(form);
        operators_.adds.push_back(adds_);
        operators_.deletes.push_back(deletes_);
        adds_ = simple_adds;
        deletes_ = simple_deletes;
    } else {
        operators_.adds.push_back(adds_);
        operators_.deletes.push_back(deletes_);
    }
    operators_.effect_offsets.push_back(operators_.effect_conditions.size());
    if (form.conditions.empty() || !wait(operators_.preconditions[op], op, -1)) fire(op);
}

bool Exploration::is_repeated(const Form& form, const Conjunction& precondition) {
    std::vector<std::int32_t> key{form.schema};
    key.insert(key.end(), binding_.begin(), binding_.begin() + std::ssize(task_.schemas[form.schema].domains));
    key.insert(key.end(), precondition.begin(), precondition.end());
    return !operators_seen_.insert(std::move(key)).second;
}

// Effects that turn out to be unconditional join adds_ and deletes_; the others are grouped by condition.
void Exploration::add_conditional_effects(const Form& form) {
    struct Change {
        Conjunction condition;
        FactId fact;
        bool positive;
        auto operator<=>(const Change&) const = default;
    };
    std::vector<Change> changes;
    for (const LiftedEffect& effect : task_.schemas[form.schema].effects) {
        if (effect.is_simple()) continue;
        joiner_.run(conditions_.join(effect.join), binding_.data(), nullptr, [&] {
            const Disjunction condition = conditions_.ground(effect.condition, binding_.data());
            if (condition.empty()) return;
            const FactId fact = ground_atom(effect.predicate, effect.terms);
            for (const Conjunction& conjunction : condition) {
                if (conjunction.empty())
                    (effect.positive ? adds_ : deletes_).push_back(fact);
                else
                    changes.push_back({conjunction, fact, effect.positive});
            }
        });
    }
    std::sort(changes.begin(), changes.end());
    changes.erase(std::unique(changes.begin(), changes.end()), changes.end());
    for (auto first = changes.begin(); first != changes.end();) {
        auto last = first;
        std::vector<FactId> adds, deletes;
        joiner_.tick(first->condition.size());
        for (; last != changes.end() && last->condition == first->condition; ++last)
            (last->positive ? adds : deletes).push_back(last->fact);
        operators_.effect_conditions.push_back(first->condition);
        operators_.effect_adds.push_back(adds);
        operators_.effect_deletes.push_back(deletes);
        first = last;
    }
}

// Enters a rule that waits for those positive literals that are not reached; false if there are none.
bool Exploration::wait(std::span<const Literal> condition, std::int32_t op, std::int32_t effect) {
    const auto rule = static_cast<std::int32_t>(rules_.size());
    std::int32_t missing = 0;
    for (const Literal literal : condition) {
        const FactId fact = grounding::fact_of(literal);
        if (is_negated(literal) || database_.is_reached(fact)) continue;
        if (waiting_.size() <= std::size_t(fact)) waiting_.resize(database_.num_facts());
        waiting_[fact].push_back(rule);
        ++missing;
    }
    if (missing > 0) rules_.push_back({missing, op, effect});
    return missing > 0;
}

void Exploration::fire(std::int32_t op) {
    operators_.reached[op] = 1;
    for (const FactId add : operators_.adds[op]) reach(add);
    for (std::int32_t e = operators_.effect_offsets[op]; e < operators_.effect_offsets[op + 1]; ++e)
        if (!wait(operators_.effect_conditions[e], op, e))
            for (const FactId add : operators_.effect_adds[e]) reach(add);
}

void Exploration::check_limits() const {
    constexpr std::size_t margin = std::size_t{1} << 24;
    constexpr std::size_t largest = std::numeric_limits<std::int32_t>::max() - margin;
    for (const std::size_t size : {operators_.preconditions.values.size(), operators_.adds.values.size(),
                                   operators_.deletes.values.size(), operators_.effect_conditions.values.size(),
                                   operators_.arguments.values.size(), 2 * std::size_t(database_.num_facts())})
        if (size > largest) throw TooLarge("the task has more than 2^31 facts, operators or conditions");
    constexpr std::size_t bytes_a_key = 128;  // roughly, in a set
    const std::size_t seen = bytes_a_key * operators_seen_.size();
    const std::size_t waiting = waiting_.capacity() * sizeof(std::vector<int>) + rules_.capacity() * (sizeof(Rule) + 8);
    // The finished task is built beside what is counted here, and is no larger.
    const std::size_t bytes = 2 * (database_.memory_bytes() + operators_.memory_bytes() + waiting + seen);
    if (bytes > memory_limit_bytes_)
        throw TooLarge("grounding needs more than the allowed " + std::to_string(memory_limit_bytes_ >> 20) + " MiB");
}

}  // namespace explicable::grounding
