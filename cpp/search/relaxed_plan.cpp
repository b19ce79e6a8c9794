#include "search/relaxed_plan.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace explicable {

namespace {

constexpr std::int32_t most_counted_cost = 1000;  // up to which counting beats comparing

std::int32_t saturated(std::int32_t a, std::int32_t b) { return std::min(a + b, infinite_cost); }

}  // namespace

RelaxedPlanner::RelaxedPlanner(const PreparedTask& prepared, std::span<const FactId> goal,
                               SupporterCost supporter_cost)
    : task_(prepared.task()),
      relaxed_(prepared.relaxed(supporter_cost)),
      goal_(goal.begin(), goal.end()),
      is_goal_(task_.num_facts(), 0),
      initial_counters_(relaxed_.size()),
      counters_(relaxed_.size()),
      fact_cost_(task_.num_facts()),
      supporter_(task_.num_facts()),
      fact_seen_(task_.num_facts(), 0),
      fact_first_(task_.num_facts(), 0),
      operator_seen_(task_.num_operators(), 0),
      several_pieces_(task_.effect_conditions.size() > 0) {
    for (const FactId fact : goal_) {
        num_goals_ += !is_goal_[fact];
        is_goal_[fact] = 1;
    }
    for (std::int32_t piece = 0; piece < relaxed_.size(); ++piece) {
        initial_counters_[piece] = {static_cast<std::int32_t>(relaxed_.preconditions[piece].size()), relaxed_.cost[piece]};
    }
}

bool RelaxedPlanner::compute(const State& state) {
    if (!explore(state)) return false;
    extract(goal_);
    if (several_pieces_) ordered_plan();
    return true;
}

// Generalised Dijkstra from the facts of the state, until all goals are reached at their final cost.
bool RelaxedPlanner::explore(const State& state) {
    queue_.clear();
    std::fill(fact_cost_.begin(), fact_cost_.end(), infinite_cost + 1);
    if (!counters_.empty()) {
        std::memcpy(counters_.data(), initial_counters_.data(), counters_.size() * sizeof(Counter));
    }
    for (VariableId variable = 0; variable < task_.num_variables(); ++variable) {
        if (const std::int32_t value = state.values[variable]) {
            reach(task_.variable_facts[variable][value - 1], 0, -1);
        }
    }
    for (const std::int32_t piece : relaxed_.without_preconditions) {
        reach_adds(piece, relaxed_.cost[piece]);
    }
    std::int32_t missing = num_goals_;
    while (missing > 0 && !queue_.empty()) {
        const auto [cost, fact] = queue_.pop();
        if (cost > fact_cost_[fact]) continue;  // reached more cheaply since
        if (is_goal_[fact] && --missing == 0) break;
        for (const std::int32_t piece : relaxed_.precondition_of[fact]) {
            Counter& counter = counters_[piece];
            counter.cost = saturated(counter.cost, cost);
            if (--counter.unsatisfied > 0) continue;
            reach_adds(piece, counter.cost);
        }
    }
    return missing == 0;
}

void RelaxedPlanner::extract(std::span<const FactId> goal) {
    if (++round_ == 0) {  // the counter of rounds has wrapped: forget all marks
        for (auto* marks : {&fact_seen_, &fact_first_, &operator_seen_}) {
            std::fill(marks->begin(), marks->end(), 0);
        }
        round_ = 1;
    }
    plan_.clear();
    supports_.clear();
    costs_.clear();
    h_add_ = 0;
    for (const FactId fact : goal) {
        h_add_ = saturated(h_add_, fact_cost_[fact]);
        if (fact_seen_[fact] != round_) extract_for(fact);
    }
}

// Depth first from a goal, so that whatever an operator needs comes before it.
void RelaxedPlanner::extract_for(FactId goal) {
    stack_.push_back({goal, 0});
    fact_seen_[goal] = round_;
    while (!stack_.empty()) {
        Visit& visit = stack_.back();
        const FactId fact = visit.fact;
        const std::int32_t support = supporter_[fact];
        if (support >= 0) {
            const std::int32_t piece = relaxed_.piece_of[support];
            const auto needed = relaxed_.preconditions[piece];
            while (visit.next < static_cast<std::int32_t>(needed.size()) && fact_seen_[needed[visit.next]] == round_) {
                ++visit.next;
            }
            if (visit.next < static_cast<std::int32_t>(needed.size())) {
                const FactId below = needed[visit.next++];
                fact_seen_[below] = round_;
                stack_.push_back({below, 0});
                continue;
            }
            if (fact_cost_[fact] == relaxed_.cost[piece]) fact_first_[fact] = round_;
            const OperatorId id = relaxed_.owner[support];
            if (several_pieces_ || operator_seen_[id] != round_) {
                operator_seen_[id] = round_;
                if (several_pieces_) supports_.push_back(support);
                costs_.push_back(fact_cost_[fact]);
                plan_.push_back(id);
            }
        }
        stack_.pop_back();
    }
}

std::span<const OperatorId> RelaxedPlanner::ordered_plan() {
    if (!several_pieces_) {
        sort_by_cost(plan_, sorted_);
        plan_.swap(sorted_);
        return plan_;
    }
    sort_by_cost(supports_, by_cost_);
    sorted_.clear();
    std::size_t layer = 0;  // where the present cost begins in sorted_
    std::int32_t layer_cost = 0;
    for (const std::int32_t support : by_cost_) {
        if (cost_of(support) != layer_cost) {
            layer_cost = cost_of(support);
            layer = sorted_.size();
        }
        const OperatorId id = relaxed_.owner[support];
        // Pieces of one operator at one cost are one execution of it.
        if (std::find(sorted_.begin() + layer, sorted_.end(), id) != sorted_.end()) continue;
        sorted_.push_back(id);
    }
    plan_.swap(sorted_);
    return plan_;
}

// Stable, so that what is needed still comes first. `values` has one value for each of `costs_`.
void RelaxedPlanner::sort_by_cost(const std::vector<std::int32_t>& values, std::vector<std::int32_t>& sorted) {
    const std::int32_t highest = costs_.empty() ? 0 : *std::max_element(costs_.begin(), costs_.end());
    sorted.resize(values.size());
    if (highest > most_counted_cost) {
        places_.resize(values.size());
        std::iota(places_.begin(), places_.end(), 0);
        std::stable_sort(places_.begin(), places_.end(), [this](std::int32_t a, std::int32_t b) { return costs_[a] < costs_[b]; });
        std::transform(places_.begin(), places_.end(), sorted.begin(), [&](std::int32_t place) { return values[place]; });
        return;
    }
    places_.assign(highest + 2, 0);
    for (const std::int32_t cost : costs_) ++places_[cost + 1];
    for (std::int32_t cost = 0; cost <= highest; ++cost) places_[cost + 1] += places_[cost];
    for (std::size_t i = 0; i < values.size(); ++i) sorted[places_[costs_[i]]++] = values[i];
}

std::span<const OperatorId> RelaxedPlanner::plan_by_goal() {
    goal_by_cost_ = goal_;
    std::stable_sort(goal_by_cost_.begin(), goal_by_cost_.end(),
                     [this](FactId a, FactId b) { return fact_cost_[a] < fact_cost_[b]; });
    extract(goal_by_cost_);
    return plan_;
}

std::int64_t RelaxedPlanner::plan_cost() const {
    std::int64_t sum = 0;
    for (const OperatorId id : plan_) sum += task_.cost[id];
    return sum;
}

void RelaxedPlanner::helpful(std::span<const OperatorId> applicable, std::vector<OperatorId>& result) const {
    result.clear();
    const auto adds_first = [this](std::span<const FactId> adds) {
        return std::any_of(adds.begin(), adds.end(), [this](FactId fact) { return fact_first_[fact] == round_; });
    };
    for (const OperatorId id : applicable) {
        bool helps = adds_first(task_.adds[id]);
        for (std::int32_t effect = task_.effect_offsets[id]; !helps && effect < task_.effect_offsets[id + 1]; ++effect) {
            helps = adds_first(task_.effect_adds[effect]);
        }
        if (helps) result.push_back(id);
    }
}

void RelaxedPlanner::in_plan(std::span<const OperatorId> applicable, std::vector<OperatorId>& result) const {
    result.clear();
    for (const OperatorId id : applicable) {
        if (operator_seen_[id] == round_) result.push_back(id);
    }
}

}  // namespace explicable
