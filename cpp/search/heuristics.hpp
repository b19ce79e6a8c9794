// Admissible heuristics, for A* and for proofs.
#pragma once

#include <string_view>
#include <memory>
#include <utility>
#include <vector>

#include "search/cost_queue.hpp"
#include "search/engine.hpp"
#include "search/relaxed_task.hpp"

namespace explicable {

class AdmissibleHeuristic {
public:
    virtual ~AdmissibleHeuristic() = default;
    // A lower bound on the cost from `state` to the goal; dead_end if there is no way.
    virtual double evaluate(const State& state) = 0;

    Monitor* monitor = nullptr;  // if any; once it wants to stop, a lower bound that takes less time will do
};

// The cheapest operator's cost in any state that is no goal.
class BlindHeuristic : public AdmissibleHeuristic {
public:
    explicit BlindHeuristic(const Question& question);
    double evaluate(const State& state) override { return question_.is_goal(state) ? 0.0 : cheapest_; }

private:
    const Question& question_;
    double cheapest_ = 0.0;
};

// h_max (Bonet & Geffner 2001) by the task's own costs and, on top of it, LM-cut: landmarks found as cuts in the
// justification graph (Helmert & Domshlak 2009).
class LandmarkCut : public AdmissibleHeuristic {
public:
    // Without `cuts` the value is h_max. A task with conditional effects gets h_max too: LM-cut would charge for an
    // operator once for each of its effects.
    LandmarkCut(const Question& question, bool cuts);
    double evaluate(const State& state) override;

private:
    struct Piece {
        std::int32_t cost;
        std::int32_t unsatisfied;
        std::int32_t base;  // the cost of its hardest precondition
        FactId hardest;
    };
    enum class Zone : char { none, goal, start };

    const Question& question_;
    bool cuts_;
    FactId goal_fact_, always_fact_;  // made up: all goals together; true from the start
    Table<FactId> preconditions_, adds_;
    Table<std::int32_t> precondition_of_, achievers_;
    std::vector<Piece> initial_pieces_, pieces_;
    std::vector<std::int32_t> fact_cost_;
    std::vector<Zone> zone_;
    std::vector<FactId> stack_;
    std::vector<std::int32_t> cut_;
    CostQueue queue_;

    void propagate();
    void propagate_decrease();
    void reach(FactId fact, std::int32_t cost);
    void reach_adds(std::int32_t piece);
    void mark_goal_zone();
    void find_cut(const State& state);
    void seed_start_zone(const State& state);
    std::int32_t charge_cut();
};

// "blind", "hmax", "lmcut", or "tour", which is LM-cut where there is nothing to tour; null for any other name.
std::unique_ptr<AdmissibleHeuristic> make_admissible(const Question& question, std::string_view name);

}  // namespace explicable
