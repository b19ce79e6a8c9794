// Mutex groups by invariant synthesis, and the finite-domain variables made of them.
//
// Helmert, "Concise finite-domain representations for PDDL planning tasks" (Artificial Intelligence 173, 2009),
// section 5: candidates say of some predicates that, for fixed values of some arguments, at most one atom is true.
// Here the schemas only propose; each group of facts is then verified on the ground operators.
#pragma once

#include <cstdint>
#include <vector>

#include "grounding/lifted.hpp"
#include "task/task.hpp"

namespace explicable::grounding {

// "For all objects x1 ... xk, at most one atom of these parts is true."
struct Candidate {
    struct Part {
        std::int32_t predicate;
        std::vector<std::int32_t> positions;  // of x1 ... xk among the arguments; at most one argument is left over
        auto operator<=>(const Part&) const = default;
    };
    std::vector<Part> parts;  // sorted, one a predicate
    auto operator<=>(const Candidate&) const = default;

    const Part* part_of(std::int32_t predicate) const {
        for (const Part& part : parts)
            if (part.predicate == predicate) return &part;
        return nullptr;
    }
};

// Candidates that every schema seems to keep balanced.
std::vector<Candidate> propose_candidates(const LiftedTask& lifted);

// The candidates' groups of at least two facts that hold at the start and that every operator preserves.
std::vector<std::vector<FactId>> find_mutex_groups(const Task& task, const std::vector<Candidate>& candidates);

// Fills in the task's variables: a greedy cover, largest group first; what is left over becomes binary.
void choose_variables(Task& task, const std::vector<std::vector<FactId>>& groups);

}  // namespace explicable::grounding
