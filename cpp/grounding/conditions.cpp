#include "grounding/conditions.hpp"

#include <algorithm>

namespace explicable::grounding {
namespace {

// Of one formula; each becomes an operator or effect of its own. Disjunctions grow no larger than what is written,
// but a product of them may grow exponentially.
constexpr std::size_t max_products = std::size_t{1} << 14;
constexpr std::size_t max_conjunctions = std::size_t{1} << 20;
// Quantifiers in each other multiply: so many parts of one condition take some seconds.
constexpr std::size_t max_expanded = std::size_t{1} << 24;

[[noreturn]] void refuse(std::size_t limit) {
    throw TooLarge("a condition splits into more than " + std::to_string(limit) + " conjunctions");
}

// Conjunction of literals that every disjunct shares, times disjunctions that don't collapse to one.
class Product {
public:
    // False if the product has become false.
    bool multiply(Disjunction&& factor) {
        if (factor.size() == 1) {
            shared_.insert(shared_.end(), factor[0].begin(), factor[0].end());
            return true;
        }
        Disjunction next;
        for (const Conjunction& left : result_)
            for (const Conjunction& right : factor) {
                Conjunction both;
                both.reserve(left.size() + right.size());
                both.insert(both.end(), left.begin(), left.end());
                both.insert(both.end(), right.begin(), right.end());
                if (!normalise(both)) continue;
                next.push_back(std::move(both));
                if (next.size() > max_products) refuse(max_products);
            }
        std::sort(next.begin(), next.end());
        next.erase(std::unique(next.begin(), next.end()), next.end());
        result_ = std::move(next);
        return !result_.empty();
    }
    Disjunction take() {
        if (!normalise(shared_)) return {};
        if (shared_.empty()) return std::move(result_);
        Disjunction all;
        for (Conjunction& conjunction : result_) {
            conjunction.insert(conjunction.end(), shared_.begin(), shared_.end());
            if (normalise(conjunction)) all.push_back(std::move(conjunction));
        }
        return all;
    }

private:
    Conjunction shared_;
    Disjunction result_{{}};
};

// Unites disjunctions, leaving out conjunctions that another one follows from.
class Sum {
public:
    // True if the sum has become true.
    bool add(Disjunction&& term) {
        for (Conjunction& conjunction : term) {
            if (conjunction.empty()) {
                result_ = {{}};
                return true;
            }
            result_.push_back(std::move(conjunction));
        }
        if (result_.size() > max_conjunctions) tidy();
        if (result_.size() > max_conjunctions) refuse(max_conjunctions);
        return false;
    }
    Disjunction take() {
        tidy();
        return std::move(result_);
    }

private:
    void tidy() {
        std::sort(result_.begin(), result_.end());
        result_.erase(std::unique(result_.begin(), result_.end()), result_.end());
        if (result_.size() > 256) return;  // quadratic from here on
        std::vector<bool> redundant(result_.size());
        for (std::size_t i = 0; i < result_.size(); ++i)
            for (std::size_t j = 0; j < result_.size() && !redundant[i]; ++j)
                redundant[i] = i != j && !redundant[j] &&
                               std::includes(result_[i].begin(), result_[i].end(), result_[j].begin(), result_[j].end());
        Disjunction kept;
        for (std::size_t i = 0; i < result_.size(); ++i)
            if (!redundant[i]) kept.push_back(std::move(result_[i]));
        result_ = std::move(kept);
    }

    Disjunction result_;
};

}  // namespace

bool normalise(Conjunction& conjunction) {
    std::sort(conjunction.begin(), conjunction.end());
    conjunction.erase(std::unique(conjunction.begin(), conjunction.end()), conjunction.end());
    for (std::size_t i = 1; i < conjunction.size(); ++i)
        if (fact_of(conjunction[i - 1]) == fact_of(conjunction[i])) return false;
    return true;
}

void ConditionGrounder::prepare(Formula& formula) {
    for (Formula& part : formula.parts) prepare(part);
    std::stable_partition(formula.parts.begin(), formula.parts.end(), [&](const Formula& part) {
        return part.kind == Formula::Kind::equality ||
               (part.kind == Formula::Kind::literal && !database_.is_fluent(part.predicate));
    });
    if (formula.kind == Formula::Kind::exists || formula.kind == Formula::Kind::forall)
        formula.join = add_join(formula.domains, formula.first_variable, formula.parts[0],
                                formula.kind == Formula::Kind::exists);
}

void ConditionGrounder::prepare(LiftedEffect& effect) {
    prepare(effect.condition);
    effect.join = add_join(effect.domains, effect.first_variable, effect.condition, true);
}

// Static literals without which an instance can't hold (exists), or can't fail to hold (forall), guide the join.
std::int32_t ConditionGrounder::add_join(const std::vector<std::int32_t>& domains, std::int32_t first_variable,
                                         const Formula& body, bool body_must_hold) {
    JoinQuery query;
    for (std::size_t i = 0; i < domains.size(); ++i)
        query.variables.push_back({first_variable + static_cast<std::int32_t>(i), domains[i]});
    auto add_guard = [&](const Formula& part) {
        const bool negated = part.negated == body_must_hold;
        if (part.kind == Formula::Kind::equality)
            query.filters.push_back({true, negated, -1, part.terms});
        else if (part.kind == Formula::Kind::literal && !database_.is_fluent(part.predicate)) {
            if (negated)
                query.filters.push_back({false, true, part.predicate, part.terms});
            else
                query.atoms.push_back({part.predicate, part.terms, -1, false});
        }
    };
    if (body.kind == (body_must_hold ? Formula::Kind::conjunction : Formula::Kind::disjunction))
        for (const Formula& part : body.parts) add_guard(part);
    else
        add_guard(body);
    joins_.push_back(plan_join(database_, query));
    return static_cast<std::int32_t>(joins_.size()) - 1;
}

Disjunction ConditionGrounder::ground(const Conjunction& known, const std::vector<const Formula*>& formulas,
                                      std::int32_t* binding) {
    num_expanded_ = 0;
    Product product;
    product.multiply({known});
    for (const Formula* formula : formulas)
        if (!product.multiply(expand(*formula, binding))) return {};
    return product.take();
}

Disjunction ConditionGrounder::ground(const Formula& formula, std::int32_t* binding) {
    num_expanded_ = 0;
    return expand(formula, binding);
}

Disjunction ConditionGrounder::expand(const Formula& formula, std::int32_t* binding) {
    if (++num_expanded_ > max_expanded)
        throw TooLarge("a condition has more than " + std::to_string(max_expanded) +
                       " parts once its quantifiers are expanded");
    const Disjunction falsity, truth{{}};
    auto value = [&](Term term) { return term >= 0 ? binding[term] : ~term; };
    switch (formula.kind) {
        case Formula::Kind::equality:
            return (value(formula.terms[0]) == value(formula.terms[1])) != formula.negated ? truth : falsity;
        case Formula::Kind::literal: {
            joiner_.tick();
            std::vector<std::int32_t> arguments;
            for (const Term term : formula.terms) arguments.push_back(value(term));
            if (!database_.is_fluent(formula.predicate)) {
                const bool holds = database_.relation(formula.predicate).find(arguments.data()) >= 0;
                return holds != formula.negated ? truth : falsity;
            }
            const FactId fact = database_.intern(formula.predicate, arguments.data());
            return {{literal(fact, formula.negated)}};
        }
        case Formula::Kind::conjunction: {
            Product product;
            for (const Formula& part : formula.parts)
                if (!product.multiply(expand(part, binding))) return falsity;
            return product.take();
        }
        case Formula::Kind::disjunction: {
            Sum sum;
            for (const Formula& part : formula.parts)
                if (sum.add(expand(part, binding))) break;
            return sum.take();
        }
        case Formula::Kind::forall: {
            Product product;
            bool is_false = false;
            joiner_.run(joins_[formula.join], binding, nullptr, [&] {
                if (!is_false) is_false = !product.multiply(expand(formula.parts[0], binding));
            });
            return is_false ? falsity : product.take();
        }
        case Formula::Kind::exists: {
            Sum sum;
            bool is_true = false;
            joiner_.run(joins_[formula.join], binding, nullptr, [&] {
                if (!is_true) is_true = sum.add(expand(formula.parts[0], binding));
            });
            return sum.take();
        }
    }
    return falsity;
}

}  // namespace explicable::grounding
