#include "grounding/ground.hpp"

#include "grounding/assembly.hpp"
#include "grounding/exploration.hpp"

namespace explicable::grounding {
namespace {

// Every fact becomes a variable of its own, except that a complement shares that of its fact.
void make_binary_variables(Task& task) {
    for (FactId fact = 0; fact < static_cast<FactId>(task.fact_predicate.size()); ++fact) {
        task.fact_variable.push_back(fact);
        task.fact_value.push_back(1);
        task.variable_facts.push_back(std::vector<FactId>{fact});
    }
}

}  // namespace

Task ground(LiftedTask& lifted, std::size_t memory_limit_bytes, const std::function<void()>& poll) {
    Exploration exploration(lifted, memory_limit_bytes, poll);
    exploration.run();
    Disjunction goal = exploration.ground_goal();
    Task task = assemble(exploration.database(), exploration.operators(), std::move(goal));
    make_binary_variables(task);
    return task;
}

}  // namespace explicable::grounding
