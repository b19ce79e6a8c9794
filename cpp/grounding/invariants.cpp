#include "grounding/invariants.hpp"

#include <algorithm>
#include <set>
#include <span>

namespace explicable::grounding {
namespace {

constexpr std::size_t max_candidates = 1000;

using Part = Candidate::Part;

struct LiftedAtom {
    std::int32_t predicate;
    std::span<const Term> terms;

    bool operator==(const LiftedAtom& other) const {
        return predicate == other.predicate && std::ranges::equal(terms, other.terms);
    }
};

std::vector<LiftedAtom> positive_conjuncts(const Formula& formula) {
    std::vector<LiftedAtom> atoms;
    auto take = [&](const Formula& part) {
        if (part.kind == Formula::Kind::literal && !part.negated) atoms.push_back({part.predicate, part.terms});
    };
    if (formula.kind == Formula::Kind::conjunction)
        for (const Formula& part : formula.parts) take(part);
    else
        take(formula);
    return atoms;
}

// What matters of a schema: what it adds, and what it deletes and had before.
struct Change {
    struct Add {
        LiftedAtom atom;
        bool simple;
    };
    std::vector<Add> adds;
    std::vector<LiftedAtom> consumed;
};

Change change_of(const Schema& schema) {
    Change change;
    const auto required = positive_conjuncts(schema.precondition);
    for (const LiftedEffect& effect : schema.effects) {
        const LiftedAtom atom{effect.predicate, effect.terms};
        if (effect.positive) {
            if (std::find(required.begin(), required.end(), atom) == required.end())
                change.adds.push_back({atom, effect.is_simple()});
            continue;
        }
        const auto condition = positive_conjuncts(effect.condition);
        if (std::find(required.begin(), required.end(), atom) != required.end() ||
            std::find(condition.begin(), condition.end(), atom) != condition.end())
            change.consumed.push_back(atom);
    }
    return change;
}

std::vector<Term> key_of(const Part& part, const LiftedAtom& atom) {
    std::vector<Term> key;
    for (const std::int32_t position : part.positions) key.push_back(atom.terms[position]);
    return key;
}

class Proposer {
public:
    explicit Proposer(const LiftedTask& lifted) : lifted_(lifted) {
        for (const Schema& schema : lifted.schemas) changes_.push_back(change_of(schema));
    }

    std::vector<Candidate> propose() {
        for (std::size_t p = 0; p < lifted_.arity.size(); ++p) {
            if (!lifted_.fluent[p]) continue;
            for (std::int32_t counted = -1; counted < lifted_.arity[p]; ++counted) {
                Part part{static_cast<std::int32_t>(p), {}};
                for (std::int32_t i = 0; i < lifted_.arity[p]; ++i)
                    if (i != counted) part.positions.push_back(i);
                enter({{part}});
            }
        }
        std::vector<Candidate> balanced;
        for (std::size_t next = 0; next < queue_.size(); ++next)
            if (const Candidate candidate = queue_[next]; check(candidate)) balanced.push_back(candidate);
        return balanced;
    }

private:
    void enter(Candidate candidate) {
        if (seen_.size() < max_candidates && seen_.insert(candidate).second) queue_.push_back(std::move(candidate));
    }

    // True if every schema seems to preserve the candidate; otherwise its refinements are entered.
    bool check(const Candidate& candidate) {
        for (const Change& change : changes_) {
            for (const Change::Add& add : change.adds) {
                const Part* part = candidate.part_of(add.atom.predicate);
                if (part == nullptr) continue;
                const std::vector<Term> key = key_of(*part, add.atom);
                if (is_too_heavy(candidate, change, add, key)) return false;
                if (is_balanced(candidate, change, add, key)) continue;
                for (const LiftedAtom& atom : change.consumed)
                    if (candidate.part_of(atom.predicate) == nullptr) refine(candidate, atom, key);
                return false;
            }
        }
        return true;
    }
    static bool is_too_heavy(const Candidate& candidate, const Change& change, const Change::Add& add,
                             const std::vector<Term>& key) {
        return std::any_of(change.adds.begin(), change.adds.end(), [&](const Change::Add& other) {
            const Part* part = candidate.part_of(other.atom.predicate);
            return part != nullptr && add.simple && other.simple && !(other.atom == add.atom) &&
                   key_of(*part, other.atom) == key;
        });
    }
    static bool is_balanced(const Candidate& candidate, const Change& change, const Change::Add& add,
                            const std::vector<Term>& key) {
        return std::any_of(change.consumed.begin(), change.consumed.end(), [&](const LiftedAtom& atom) {
            const Part* part = candidate.part_of(atom.predicate);
            return part != nullptr && !(atom == add.atom) && key_of(*part, atom) == key;
        });
    }

    // Adds the atom's predicate in every way that matches the key and leaves at most one argument over.
    void refine(const Candidate& candidate, const LiftedAtom& atom, const std::vector<Term>& key) {
        if (atom.terms.size() < key.size() || atom.terms.size() > key.size() + 1) return;
        std::vector<std::int32_t> positions;
        match(candidate, atom, key, positions);
    }
    void match(const Candidate& candidate, const LiftedAtom& atom, const std::vector<Term>& key,
               std::vector<std::int32_t>& positions) {
        if (positions.size() == key.size()) {
            Candidate refined = candidate;
            refined.parts.push_back({atom.predicate, positions});
            std::sort(refined.parts.begin(), refined.parts.end());
            enter(std::move(refined));
            return;
        }
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(atom.terms.size()); ++i) {
            if (atom.terms[i] != key[positions.size()] ||
                std::find(positions.begin(), positions.end(), i) != positions.end())
                continue;
            positions.push_back(i);
            match(candidate, atom, key, positions);
            positions.pop_back();
        }
    }

    const LiftedTask& lifted_;
    std::vector<Change> changes_;
    std::set<Candidate> seen_;
    std::vector<Candidate> queue_;
};

}  // namespace

std::vector<Candidate> propose_candidates(const LiftedTask& lifted) { return Proposer(lifted).propose(); }

}  // namespace explicable::grounding
