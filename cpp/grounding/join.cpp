#include "grounding/join.hpp"

#include <algorithm>
#include <map>

namespace explicable::grounding {
namespace {

class Planner {
public:
    Planner(Database& database, const JoinQuery& query) : database_(database), query_(query) {
        for (const auto& [variable, domain] : query.variables) domain_[variable] = domain;
        for (const auto& [variable, domain] : query.variables) unbound_[variable] = true;
        filter_done_.resize(query.filters.size());
        atom_done_.resize(query.atoms.size());
    }

    JoinPlan plan(std::int32_t trigger) {
        JoinPlan plan;
        if (trigger >= 0) {
            plan.trigger = atom_step(query_.atoms[trigger], false);
            atom_done_[trigger] = true;
        }
        add_filters(plan);
        while (true) {
            std::int32_t best = -1;
            double best_estimate = 0;
            for (std::size_t i = 0; i < query_.atoms.size(); ++i) {
                if (atom_done_[i]) continue;
                const double estimate = expected_matches(query_.atoms[i]);
                if (best < 0 || estimate < best_estimate) {
                    best = static_cast<std::int32_t>(i);
                    best_estimate = estimate;
                }
            }
            if (best < 0) break;
            atom_done_[best] = true;
            plan.steps.push_back(atom_step(query_.atoms[best], true));
            add_filters(plan);
        }
        for (const auto& [variable, domain] : query_.variables) {
            if (!unbound_[variable]) continue;
            JoinStep step;
            step.kind = JoinStep::Kind::enumerate;
            step.binds.push_back({-1, variable, domain});
            unbound_[variable] = false;
            plan.steps.push_back(std::move(step));
            add_filters(plan);
        }
        return plan;
    }

private:
    bool is_unbound(Term term) const {
        if (term < 0) return false;
        const auto found = unbound_.find(term);
        return found != unbound_.end() && found->second;
    }

    void add_filters(JoinPlan& plan) {
        for (std::size_t i = 0; i < query_.filters.size(); ++i) {
            const JoinFilter& filter = query_.filters[i];
            if (filter_done_[i] ||
                std::any_of(filter.terms.begin(), filter.terms.end(), [&](Term t) { return is_unbound(t); }))
                continue;
            filter_done_[i] = true;
            JoinStep step;
            step.kind = filter.is_equality ? JoinStep::Kind::equality
                        : filter.negated   ? JoinStep::Kind::absent
                                           : JoinStep::Kind::lookup;
            step.negated = filter.negated;
            step.predicate = filter.predicate;
            step.terms.assign(filter.terms.begin(), filter.terms.end());
            plan.steps.push_back(std::move(step));
        }
    }

    // Static relations are known; of fluent ones, whatever the types allow is expected to be reached.
    double expected_matches(const JoinAtom& atom) {
        const bool fluent = database_.is_fluent(atom.predicate);
        double estimate = fluent ? 1.0 : database_.relation(atom.predicate).size();
        std::vector<Term> seen;
        for (std::size_t position = 0; position < atom.terms.size(); ++position) {
            const Term term = atom.terms[position];
            const bool known = !is_unbound(term) || std::find(seen.begin(), seen.end(), term) != seen.end();
            if (known && !fluent)
                estimate /= std::max(1.0, num_distinct(atom.predicate, static_cast<std::int32_t>(position)));
            else if (!known && fluent)
                estimate *= static_cast<double>(database_.task().domains[domain_.at(term)].size());
            seen.push_back(term);
        }
        return estimate;
    }
    double num_distinct(std::int32_t predicate, std::int32_t position) {
        const auto [entry, is_new] = distinct_.try_emplace({predicate, position}, 0);
        if (is_new) {
            const Relation& relation = database_.relation(predicate);
            std::vector<std::uint8_t> seen(database_.task().num_objects);
            for (RowId row = 0; row < relation.size(); ++row) seen[relation.row(row)[position]] = 1;
            entry->second = std::count(seen.begin(), seen.end(), 1);
        }
        return static_cast<double>(entry->second);
    }

    JoinStep atom_step(const JoinAtom& atom, bool indexed) {
        JoinStep step;
        step.predicate = atom.predicate;
        step.slot = atom.slot;
        step.not_trigger = atom.not_trigger;
        step.terms.assign(atom.terms.begin(), atom.terms.end());
        for (std::int32_t position = 0; position < static_cast<std::int32_t>(atom.terms.size()); ++position) {
            const Term term = atom.terms[position];
            const auto bound_here = std::find_if(step.binds.begin(), step.binds.end(),
                                                 [&](const auto& bind) { return bind.variable == term; });
            if (bound_here != step.binds.end()) {
                step.same.emplace_back(bound_here->position, position);
            } else if (is_unbound(term)) {
                const std::int32_t domain = domain_.at(term);
                const bool everything = std::ssize(database_.task().domains[domain]) == database_.task().num_objects;
                step.binds.push_back({position, term, everything ? -1 : domain});
            } else {
                step.key_positions.push_back(position);
                step.key.push_back(term);
            }
        }
        for (const auto& bind : step.binds) unbound_[bind.variable] = false;
        if (indexed && step.binds.empty()) {
            step.kind = JoinStep::Kind::lookup;
        } else if (indexed) {
            step.index = database_.relation(atom.predicate).make_index(step.key_positions);
            step.verify = !database_.relation(atom.predicate).index(step.index).exact;
        }
        return step;
    }

    Database& database_;
    const JoinQuery& query_;
    std::map<std::int32_t, std::int32_t> domain_;
    std::map<std::int32_t, bool> unbound_;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int64_t> distinct_;
    std::vector<bool> filter_done_, atom_done_;
};

}  // namespace

JoinPlan plan_join(Database& database, const JoinQuery& query, std::int32_t trigger) {
    return Planner(database, query).plan(trigger);
}

}  // namespace explicable::grounding
