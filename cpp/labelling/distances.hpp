// How far facts are from requests and goals, counted in operators, in the robot's own model and in the mental model.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "labelling/team_tables.hpp"
#include "task/task.hpp"

namespace explicable {

// What an operator may make true, conditional effects included; sorted.
std::vector<FactId> all_adds(const Task& task, OperatorId op);

// The preconditions that an operator uses up; all of them where it uses none up.
std::vector<FactId> used_up(const Task& task, OperatorId op);

// An operator leads from each precondition that it uses up to each fact that it adds. Distances count such
// transitions, backwards from a target.
class TransitionGraph {
public:
    explicit TransitionGraph(const Task& task);

    // Distance of every fact to what a request asks for: the other preconditions of the operators that need one of its
    // facts; -1 stands for a fact that the task does not have.
    std::vector<Distance> to_request(std::span<const FactId> request, const std::vector<std::uint8_t>& human_operator) const;
    // Distance of every fact to a goal: 0 for the goal itself, 1 for what its achievers need.
    std::vector<Distance> to_goal(FactId goal) const;

private:
    const Task& task_;
    std::vector<std::vector<OperatorId>> adders_, users_;
    Table<FactId> sources_;

    std::vector<Distance> nowhere() const;
    void start_from(OperatorId op, std::span<const FactId> target, std::vector<FactId>& queue,
                    std::vector<Distance>& distance) const;
    void spread(std::vector<FactId>& queue, std::vector<Distance>& distance) const;
};

// Distances in both models, over the facts of the composite task.
class Measure {
public:
    // `mental_fact`: the mental task's number of each fact, or -1.
    Measure(const Task& composite, const Task& mental, std::vector<FactId> mental_fact,
            std::vector<std::uint8_t> own_human, std::vector<std::uint8_t> mental_human)
        : composite(composite),
          own_graph_(composite),
          mental_graph_(mental),
          mental_fact_(std::move(mental_fact)),
          own_human_(std::move(own_human)),
          mental_human_(std::move(mental_human)) {}

    using Both = std::array<std::vector<Distance>, 2>;  // by Model
    Both to_request(std::span<const FactId> facts) const {
        std::vector<FactId> theirs;
        for (const auto fact : facts) theirs.push_back(mental_fact_[fact]);
        return both(mental_graph_.to_request(theirs, mental_human_), own_graph_.to_request(facts, own_human_));
    }
    Both to_goal(FactId fact) const {
        return both(mental_graph_.to_goal(mental_fact_[fact]), own_graph_.to_goal(fact));
    }

    const Task& composite;

private:
    Both both(const std::vector<Distance>& mental, std::vector<Distance>&& own) const;

    TransitionGraph own_graph_, mental_graph_;
    std::vector<FactId> mental_fact_;
    std::vector<std::uint8_t> own_human_, mental_human_;
};

}  // namespace explicable
