#include "grounding/ground.hpp"

#include "grounding/assembly.hpp"
#include "grounding/exploration.hpp"
#include "grounding/invariants.hpp"

namespace explicable::grounding {

Task ground(LiftedTask& lifted, std::size_t memory_limit_bytes, const std::function<void()>& poll) {
    Exploration exploration(lifted, memory_limit_bytes, poll);
    exploration.run();
    Disjunction goal = exploration.ground_goal();
    Task task = assemble(exploration.database(), exploration.operators(), std::move(goal));
    poll();
    choose_variables(task, find_mutex_groups(task, propose_candidates(lifted)));
    return task;
}

}  // namespace explicable::grounding
