#include "labelling/distances.hpp"

#include <algorithm>
#include <iterator>

namespace explicable {

std::vector<FactId> all_adds(const Task& task, OperatorId op) {
    const auto plain = task.adds[op];
    std::vector<FactId> facts(plain.begin(), plain.end());
    for (auto effect = task.effect_offsets[op]; effect < task.effect_offsets[op + 1]; ++effect)
        facts.insert(facts.end(), task.effect_adds[effect].begin(), task.effect_adds[effect].end());
    std::ranges::sort(facts);
    return facts;
}

std::vector<FactId> used_up(const Task& task, OperatorId op) {
    const auto preconditions = task.preconditions[op];
    std::vector<FactId> used;
    std::ranges::set_intersection(preconditions, task.deletes[op], std::back_inserter(used));
    return used.empty() ? std::vector<FactId>(preconditions.begin(), preconditions.end()) : used;
}

TransitionGraph::TransitionGraph(const Task& task)
    : task_(task), adders_(task.num_facts()), users_(task.num_facts()) {
    for (OperatorId op = 0; op < task.num_operators(); ++op) {
        sources_.push_back(used_up(task, op));
        for (const auto fact : all_adds(task, op)) adders_[fact].push_back(op);
        for (const auto fact : task.preconditions[op]) users_[fact].push_back(op);
    }
}

std::vector<Distance> TransitionGraph::to_request(std::span<const FactId> request,
                                                  const std::vector<std::uint8_t>& human_operator) const {
    std::vector<Distance> distance = nowhere();
    std::vector<FactId> queue;
    for (const auto fact : request)
        if (fact >= 0)
            for (const auto op : users_[fact])
                if (!human_operator[op]) start_from(op, request, queue, distance);
    spread(queue, distance);
    return distance;
}

std::vector<Distance> TransitionGraph::to_goal(FactId goal) const {
    std::vector<Distance> distance = nowhere();
    if (goal < 0) return distance;
    distance[goal] = 0;
    std::vector<FactId> queue;
    for (const auto op : adders_[goal]) start_from(op, {&goal, 1}, queue, distance);
    spread(queue, distance);
    return distance;
}

std::vector<Distance> TransitionGraph::nowhere() const {
    return std::vector<Distance>(static_cast<std::size_t>(task_.num_facts()), kNoWay);
}

// What an operator needs is one step away, but for the target itself.
void TransitionGraph::start_from(OperatorId op, std::span<const FactId> target, std::vector<FactId>& queue,
                                 std::vector<Distance>& distance) const {
    for (const auto fact : task_.preconditions[op]) {
        if (distance[fact] != kNoWay || std::ranges::find(target, fact) != target.end()) continue;
        distance[fact] = 1;
        queue.push_back(fact);
    }
}

// `distance` of each fact to the nearest of `queue`, whose own distances are set already (all alike).
void TransitionGraph::spread(std::vector<FactId>& queue, std::vector<Distance>& distance) const {
    std::vector<bool> fired(static_cast<std::size_t>(task_.num_operators()));
    for (std::size_t next = 0; next < queue.size(); ++next) {
        const Distance farther = static_cast<Distance>(std::min<int>(distance[queue[next]] + 1, kNoWay - 1));
        for (const auto op : adders_[queue[next]]) {
            if (fired[op]) continue;
            fired[op] = true;
            for (const auto fact : sources_[op]) {
                if (distance[fact] != kNoWay) continue;
                distance[fact] = farther;
                queue.push_back(fact);
            }
        }
    }
}

Measure::Both Measure::both(const std::vector<Distance>& mental, std::vector<Distance>&& own) const {
    std::vector<Distance> translated(mental_fact_.size(), kNoWay);
    for (std::size_t fact = 0; fact < mental_fact_.size(); ++fact)
        if (mental_fact_[fact] >= 0) translated[fact] = mental[mental_fact_[fact]];
    return {std::move(translated), std::move(own)};
}

}  // namespace explicable
