// The ground side of invariant synthesis: instances of the candidates, verified and made into variables.
#include <algorithm>
#include <queue>
#include <span>
#include <utility>

#include "grounding/invariants.hpp"

namespace explicable::grounding {
namespace {

using Facts = std::span<const FactId>;
using Groups = std::vector<std::vector<FactId>>;

bool contains(Facts facts, FactId fact) { return std::binary_search(facts.begin(), facts.end(), fact); }

// All groups of the candidates, facts sorted, each group once.
Groups instantiate(const Task& task, const std::vector<Candidate>& candidates) {
    std::vector<std::vector<FactId>> by_predicate;
    for (FactId fact = 0; fact < static_cast<FactId>(task.fact_predicate.size()); ++fact) {
        const std::int32_t predicate = task.fact_predicate[fact];
        if (predicate < 0) continue;
        if (by_predicate.size() <= std::size_t(predicate)) by_predicate.resize(predicate + 1);
        by_predicate[predicate].push_back(fact);
    }
    Groups groups;
    for (const Candidate& candidate : candidates) {
        std::vector<std::pair<std::vector<std::int32_t>, FactId>> keyed;
        for (const Candidate::Part& part : candidate.parts) {
            if (std::size_t(part.predicate) >= by_predicate.size()) continue;
            for (const FactId fact : by_predicate[part.predicate]) {
                std::vector<std::int32_t> key;
                for (const std::int32_t position : part.positions)
                    key.push_back(task.fact_arguments[fact][position]);
                keyed.emplace_back(std::move(key), fact);
            }
        }
        std::sort(keyed.begin(), keyed.end());
        for (auto first = keyed.begin(); first != keyed.end();) {
            const auto last = std::find_if(first, keyed.end(), [&](const auto& k) { return k.first != first->first; });
            std::vector<FactId> group;
            for (auto entry = first; entry != last; ++entry) group.push_back(entry->second);
            if (group.size() >= 2) groups.push_back(std::move(group));
            first = last;
        }
    }
    std::sort(groups.begin(), groups.end());
    groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
    return groups;
}

class Verifier {
public:
    Verifier(const Task& task, const Groups& groups)
        : task_(task), groups_(groups), holds_(groups.size(), true), groups_of_(task.fact_predicate.size()) {
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const auto weight = std::count_if(groups[g].begin(), groups[g].end(),
                                              [&](FactId fact) { return contains(task.initial, fact); });
            holds_[g] = weight <= 1;
            if (holds_[g])
                for (const FactId fact : groups[g]) groups_of_[fact].push_back(static_cast<std::int32_t>(g));
        }
    }

    std::vector<bool> verify() {
        for (OperatorId op = 0; op < task_.num_operators(); ++op) {
            check_adds(op, task_.adds[op]);
            for (std::int32_t e = task_.effect_offsets[op]; e < task_.effect_offsets[op + 1]; ++e)
                check_adds(op, task_.effect_adds[e]);
        }
        return std::move(holds_);
    }

private:
    void check_adds(OperatorId op, Facts adds) {
        for (const FactId fact : adds)
            for (const std::int32_t group : groups_of_[fact])
                if (holds_[group]) holds_[group] = preserves(op, group);
    }
    bool in_group(FactId fact, std::int32_t group) const {
        return std::find(groups_of_[fact].begin(), groups_of_[fact].end(), group) != groups_of_[fact].end();
    }

    // A way in which an operator adds to a group: what is added, and which fact of the group is known to be true then.
    struct Adder {
        FactId added = -1, known = -1;
    };
    enum class Verdict { adds_nothing, never_fires, preserves, violates };

    // Does the unconditional effect (-1), or a conditional one taken alone, keep the group's weight at one?
    Verdict judge(OperatorId op, std::int32_t effect, std::int32_t group, Adder& adder) const {
        adder = {};
        for (const FactId fact : effect < 0 ? task_.adds[op] : task_.effect_adds[effect]) {
            if (!in_group(fact, group)) continue;
            if (adder.added >= 0) return Verdict::violates;
            adder.added = fact;
        }
        if (adder.added < 0) return Verdict::adds_nothing;
        for (const Facts facts : {task_.preconditions[op], effect < 0 ? Facts{} : task_.effect_conditions[effect]})
            for (const FactId fact : facts) {
                if (!in_group(fact, group) || fact == adder.known) continue;
                if (adder.known >= 0) return Verdict::never_fires;
                adder.known = fact;
            }
        const bool replaced = adder.known == adder.added || contains(task_.deletes[op], adder.known) ||
                              (effect >= 0 && contains(task_.effect_deletes[effect], adder.known));
        return (adder.known >= 0 && replaced) || clears(op, group, adder.added) ? Verdict::preserves
                                                                                : Verdict::violates;
    }
    // Does the operator make all facts of the group false but one, whatever the state?
    bool clears(OperatorId op, std::int32_t group, FactId but) const {
        const std::int32_t first = task_.effect_offsets[op], last = task_.effect_offsets[op + 1];
        auto cleared = [&](FactId fact) {
            if (fact == but || contains(task_.deletes[op], fact)) return true;
            for (std::int32_t e = first; e < last; ++e) {
                if (!contains(task_.effect_deletes[e], fact)) continue;
                const Facts condition = task_.effect_conditions[e];
                if (std::all_of(condition.begin(), condition.end(), [&](FactId f) { return f == fact; })) return true;
            }
            return false;
        };
        return std::all_of(groups_[group].begin(), groups_[group].end(), cleared);
    }
    bool preserves(OperatorId op, std::int32_t group) const {
        std::vector<Adder> adders;
        Adder adder;
        for (std::int32_t e = -1; e < task_.effect_offsets[op + 1] - task_.effect_offsets[op]; ++e) {
            const std::int32_t effect = e < 0 ? -1 : task_.effect_offsets[op] + e;
            const Verdict verdict = judge(op, effect, group, adder);
            if (verdict == Verdict::violates) return false;
            if (verdict == Verdict::preserves) adders.push_back(adder);
        }
        // Two that add different facts must not fire together.
        for (std::size_t i = 0; i < adders.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                if (adders[i].added != adders[j].added &&
                    (adders[i].known < 0 || adders[j].known < 0 || adders[i].known == adders[j].known))
                    return false;
        return true;
    }

    const Task& task_;
    const Groups& groups_;
    std::vector<bool> holds_;
    std::vector<std::vector<std::int32_t>> groups_of_;
};

// A fact and its complement.
Groups complement_pairs(const Task& task) {
    std::vector<std::pair<std::pair<std::int32_t, std::vector<std::int32_t>>, FactId>> named;
    std::vector<std::uint8_t> negated_predicate;
    for (const std::int32_t predicate : task.fact_predicate)
        if (predicate < 0 && predicate != auxiliary) {
            if (negated_predicate.size() <= std::size_t(~predicate)) negated_predicate.resize(~predicate + 1);
            negated_predicate[~predicate] = 1;
        }
    for (FactId fact = 0; fact < static_cast<FactId>(task.fact_predicate.size()); ++fact) {
        const std::int32_t predicate = task.fact_predicate[fact];
        if (predicate == auxiliary) continue;
        const std::int32_t name = std::max(predicate, ~predicate);
        if (std::size_t(name) >= negated_predicate.size() || !negated_predicate[name]) continue;
        const auto row = task.fact_arguments[fact];
        named.push_back({{name, {row.begin(), row.end()}}, fact});
    }
    std::sort(named.begin(), named.end());
    Groups pairs;
    for (std::size_t i = 1; i < named.size(); ++i)
        if (named[i - 1].first == named[i].first) pairs.push_back({named[i - 1].second, named[i].second});
    return pairs;
}

}  // namespace

Groups find_mutex_groups(const Task& task, const std::vector<Candidate>& candidates) {
    Groups groups = instantiate(task, candidates);
    const std::vector<bool> holds = Verifier(task, groups).verify();
    Groups result = complement_pairs(task);
    for (std::size_t g = 0; g < groups.size(); ++g)
        if (holds[g]) result.push_back(std::move(groups[g]));
    return result;
}

void choose_variables(Task& task, const Groups& groups) {
    const auto num_facts = static_cast<FactId>(task.fact_predicate.size());
    task.fact_variable.assign(num_facts, -1);
    task.fact_value.assign(num_facts, 0);
    auto make_variable = [&](const std::vector<FactId>& facts) {
        std::int32_t value = 0;
        for (const FactId fact : facts) {
            task.fact_variable[fact] = task.variable_facts.size();
            task.fact_value[fact] = ++value;
        }
        task.variable_facts.push_back(facts);
    };
    using Entry = std::pair<std::size_t, std::ptrdiff_t>;  // number of facts not yet covered, minus the group's number
    std::priority_queue<Entry> queue;
    for (std::size_t g = 0; g < groups.size(); ++g) queue.push({groups[g].size(), -static_cast<std::ptrdiff_t>(g)});
    while (!queue.empty()) {
        const auto [size, minus_group] = queue.top();
        queue.pop();
        std::vector<FactId> open;
        for (const FactId fact : groups[-minus_group])
            if (task.fact_variable[fact] < 0) open.push_back(fact);
        if (open.size() < 2) continue;
        if (open.size() == size)
            make_variable(open);
        else
            queue.push({open.size(), minus_group});
    }
    for (FactId fact = 0; fact < num_facts; ++fact)
        if (task.fact_variable[fact] < 0) make_variable({fact});
}

}  // namespace explicable::grounding
