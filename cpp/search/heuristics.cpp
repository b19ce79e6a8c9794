#include "search/heuristics.hpp"

#include <algorithm>

#include "search/tour.hpp"

namespace explicable {

BlindHeuristic::BlindHeuristic(const Question& question) : question_(question) {
    const auto& cost = question.task.cost;
    if (!cost.empty()) cheapest_ = std::max(0, *std::min_element(cost.begin(), cost.end()));
}

LandmarkCut::LandmarkCut(const Question& question, bool cuts)
    : question_(question),
      cuts_(cuts && question.task.effect_conditions.size() == 0),
      goal_fact_(question.task.num_facts()),
      always_fact_(goal_fact_ + 1),
      fact_cost_(always_fact_ + 1),
      zone_(always_fact_ + 1) {
    const RelaxedTask relaxed(question.task, SupporterCost::unit);
    const auto add_piece = [this](std::span<const FactId> needed, std::span<const FactId> adds, std::int32_t cost) {
        const FactId always[] = {always_fact_};
        preconditions_.push_back(needed.empty() ? std::span<const FactId>(always) : needed);
        adds_.push_back(adds);
        const auto unsatisfied = static_cast<std::int32_t>(std::max<std::size_t>(needed.size(), 1));
        initial_pieces_.push_back({cost, unsatisfied, infinite_cost, always_fact_});
    };
    for (std::int32_t piece = 0; piece < relaxed.size(); ++piece) {
        if (relaxed.adds[piece].empty()) continue;
        const OperatorId owner = relaxed.owner[relaxed.adds.offsets[piece]];
        const std::int32_t cost = std::clamp(question.task.cost[owner], 0, max_operator_cost);
        add_piece(relaxed.preconditions[piece], relaxed.adds[piece], cost);
    }
    std::vector<FactId> goal(question.goal);
    std::sort(goal.begin(), goal.end());
    goal.erase(std::unique(goal.begin(), goal.end()), goal.end());
    const FactId goal_fact[] = {goal_fact_};
    add_piece(goal, goal_fact, 0);
    precondition_of_ = inverse(preconditions_, always_fact_ + 1);
    achievers_ = inverse(adds_, always_fact_ + 1);
}

double LandmarkCut::evaluate(const State& state) {
    pieces_ = initial_pieces_;
    std::fill(fact_cost_.begin(), fact_cost_.end(), infinite_cost + 1);
    queue_.clear();
    seed_start_zone(state);
    for (const FactId fact : stack_) reach(fact, 0);
    propagate();
    if (fact_cost_[goal_fact_] > infinite_cost) return dead_end;
    if (!cuts_) return fact_cost_[goal_fact_];
    double sum = 0.0;
    while (fact_cost_[goal_fact_] > 0) {
        if (monitor && monitor->is_time_up()) return sum + fact_cost_[goal_fact_];
        std::fill(zone_.begin(), zone_.end(), Zone::none);
        mark_goal_zone();
        find_cut(state);
        if (cut_.empty()) break;  // only where saturated costs hide the way
        sum += charge_cut();
        propagate_decrease();
    }
    return sum;
}

void LandmarkCut::seed_start_zone(const State& state) {
    stack_.assign(1, always_fact_);
    for (VariableId variable = 0; variable < question_.task.num_variables(); ++variable) {
        if (const std::int32_t value = state.values[variable]) {
            stack_.push_back(question_.task.variable_facts[variable][value - 1]);
        }
    }
}

void LandmarkCut::reach(FactId fact, std::int32_t cost) {
    if (cost >= fact_cost_[fact]) return;
    fact_cost_[fact] = cost;
    queue_.push(cost, fact);
}

void LandmarkCut::reach_adds(std::int32_t piece) {
    const std::int32_t cost = std::min(pieces_[piece].base + pieces_[piece].cost, infinite_cost);
    for (const FactId fact : adds_[piece]) reach(fact, cost);
}

// Facts are popped in the order of their cost, so the last precondition to arrive is the hardest one.
void LandmarkCut::propagate() {
    while (!queue_.empty()) {
        const auto [cost, fact] = queue_.pop();
        if (cost > fact_cost_[fact]) continue;
        for (const std::int32_t index : precondition_of_[fact]) {
            Piece& piece = pieces_[index];
            if (--piece.unsatisfied > 0) continue;
            piece.hardest = fact;
            piece.base = cost;
            reach_adds(index);
        }
    }
}

// After some costs have fallen: only pieces whose hardest precondition became cheaper can change.
void LandmarkCut::propagate_decrease() {
    while (!queue_.empty()) {
        const auto [cost, fact] = queue_.pop();
        if (cost > fact_cost_[fact]) continue;
        for (const std::int32_t index : precondition_of_[fact]) {
            Piece& piece = pieces_[index];
            if (piece.unsatisfied > 0 || piece.hardest != fact || piece.base <= cost) continue;
            const auto needed = preconditions_[index];
            piece.hardest = *std::max_element(needed.begin(), needed.end(), [this](FactId a, FactId b) {
                return fact_cost_[a] < fact_cost_[b];
            });
            if (fact_cost_[piece.hardest] == piece.base) continue;
            piece.base = fact_cost_[piece.hardest];
            reach_adds(index);
        }
    }
}

// Facts from which the goal costs nothing more, going back through hardest preconditions.
void LandmarkCut::mark_goal_zone() {
    stack_.assign(1, goal_fact_);
    zone_[goal_fact_] = Zone::goal;
    while (!stack_.empty()) {
        const FactId fact = stack_.back();
        stack_.pop_back();
        for (const std::int32_t index : achievers_[fact]) {
            const Piece& piece = pieces_[index];
            if (piece.unsatisfied > 0 || piece.cost > 0 || zone_[piece.hardest] == Zone::goal) continue;
            zone_[piece.hardest] = Zone::goal;
            stack_.push_back(piece.hardest);
        }
    }
}

// The pieces that lead from what the state reaches, outside the goal zone, into it.
void LandmarkCut::find_cut(const State& state) {
    cut_.clear();
    seed_start_zone(state);
    for (const FactId fact : stack_) zone_[fact] = Zone::start;
    while (!stack_.empty()) {
        const FactId fact = stack_.back();
        stack_.pop_back();
        for (const std::int32_t index : precondition_of_[fact]) {
            const Piece& piece = pieces_[index];
            if (piece.unsatisfied > 0 || piece.hardest != fact) continue;
            const auto adds = adds_[index];
            if (std::any_of(adds.begin(), adds.end(), [this](FactId f) { return zone_[f] == Zone::goal; })) {
                cut_.push_back(index);
                continue;
            }
            for (const FactId added : adds) {
                if (zone_[added] != Zone::none) continue;
                zone_[added] = Zone::start;
                stack_.push_back(added);
            }
        }
    }
}

std::int32_t LandmarkCut::charge_cut() {
    std::int32_t lowest = infinite_cost;
    for (const std::int32_t index : cut_) lowest = std::min(lowest, pieces_[index].cost);
    queue_.clear();  // it is empty, but must start over from the lowest cost
    for (const std::int32_t index : cut_) {
        pieces_[index].cost -= lowest;
        reach_adds(index);
    }
    return lowest;
}

std::unique_ptr<AdmissibleHeuristic> make_admissible(const Question& question, std::string_view name) {
    if (name == "blind") return std::make_unique<BlindHeuristic>(question);
    if (name == "hmax") return std::make_unique<LandmarkCut>(question, false);
    if (name == "lmcut") return std::make_unique<LandmarkCut>(question, true);
    if (name == "tour") {
        KnownMoves moves;
        Tour tour(question, find_possible(question.prepared, question.initial).operators, moves);
        if (tour.exists()) return std::make_unique<TourHeuristic>(std::move(tour));
        return make_admissible(question, "lmcut");
    }
    return nullptr;
}

}  // namespace explicable
