// What lies ahead at the least, by sweeps over all states, or contexts, that can be reached in a task that is small enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "search/engine.hpp"
#include "search/heuristics.hpp"
#include "search/path_scorer.hpp"
#include "search/rows.hpp"
#include "task/packed_state.hpp"
#include "task/state_registry.hpp"

namespace explicable {

// Steps between numbered places, with weights.
class StepGraph {
public:
    struct Edge {
        std::int32_t from, to;
        OperatorId step;
        double weight;
    };
    std::vector<Edge> edges;

    // In: the least of what it costs to end in each place, or to leave the graph there. Out: the least of all that lies ahead.
    void sweep(std::vector<double>& ahead) const;
    void reverse();
};

// Exact costs to the goal where all reachable states could be listed, else an admissible heuristic; or, near a plan, the exact
// costs of going on among the states near it.
class CostToGo {
public:
    // What lies on no plan of at most `max_cost`, as far as states alone can say, is a dead end.
    CostToGo(const Question& question, const StatePacker& packer, std::int64_t max_cost);
    // Lists states until there are more than `max_states`, or the monitor stops.
    void list(Monitor& monitor, std::int32_t max_states);
    // Lists states in the order of their distance from those of a plan. All others are dead ends from then on.
    void list_near(Monitor& monitor, const std::vector<OperatorId>& plan, std::int32_t max_states);
    double operator()(const Word* words) const;
    bool is_exact() const { return !costs_.empty(); }
    std::size_t memory_bytes() const;

private:
    const Question& question_;
    const StatePacker& packer_;
    std::int64_t max_cost_;
    StateRegistry states_;
    std::vector<double> costs_;
    std::unique_ptr<AdmissibleHeuristic> heuristic_;

    std::int32_t expand(Monitor& monitor, std::int32_t max_states, StepGraph& graph);
    void sweep(StepGraph& graph);
};

// Lower bounds of cost + charge + alpha * inexplicable steps from a context to the goal: the scorer's bounds for single steps, summed
// along the best continuation. Contexts that were not listed get their cost-to-go.
class Outlook {
public:
    // Without a scorer: of the cost alone.
    Outlook(const Question& question, const PathScorer* scorer, double alpha, std::int64_t max_cost = no_max_cost);

    // Lists contexts through which a plan may have a lower objective than `bound`. Plans found on the way are offered; the
    // answer is the new bound. Returns false if the monitor stopped.
    using Offer = std::function<double(std::vector<OperatorId>)>;
    bool prepare(Monitor& monitor, double bound, const Offer& offer);

    // The same within the neighbourhood of a plan, outside of which all is a dead end.
    bool prepare_near(Monitor& monitor, const std::vector<OperatorId>& plan, std::int32_t max_states, double bound,
                      const Offer& offer);

    // `words`: the packed state.
    double operator()(const Word* words, const std::byte* context) const;
    // Whether a path of some cost to a state may be part of a plan of at most the greatest cost.
    bool affords(std::int64_t cost, const Word* words) const {
        return max_cost_ == no_max_cost || static_cast<double>(cost) + cost_to_go_(words) <= static_cast<double>(max_cost_);
    }
    double from_start() const;
    std::size_t memory_bytes() const;
    bool is_complete() const { return is_complete_; }
    bool is_exact() const { return cost_to_go_.is_exact(); }  // all states that can be reached were listed

private:
    const Question& question_;
    const PathScorer* scorer_;
    double alpha_;
    std::int64_t max_cost_;
    StatePacker packer_;
    CostToGo cost_to_go_;
    StateRegistry places_;  // states with outlook keys
    Rows<std::byte> contexts_;
    StepGraph graph_;
    std::vector<double> ahead_;
    mutable std::vector<Word> key_;
    bool is_complete_ = false;

    bool sweep(Monitor& monitor, double bound, const Offer& offer);
    const Word* with_key(const Word* words, const std::byte* context) const;
    bool list(Monitor& monitor, double bound, const Offer& offer);
    void weigh();
};

}  // namespace explicable
