// A lower bound for goals that lie in many places of one variable: the shortest tour of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "search/heuristics.hpp"

namespace explicable {

// Let one variable move, a robot's place say, and forget all else that its moves need. Where everything that achieves a goal
// needs one value of it, that value has to be visited: what all visits cost together is a travelling-salesman path
// without return (Held & Karp 1962) over distances in the variable's transition graph. On top of that, each fact that is
// still lacking and needed in any case costs the cheapest operator that adds it; no operator is charged for twice.
// Exact where other facts of the task hold no move up, as on a floor plan that one robot searches.
class TourHeuristic : public AdmissibleHeuristic {
public:
    explicit TourHeuristic(const Question& question);
    double evaluate(const State& state) override;
    bool has_tour() const { return !stops_.empty(); }

private:
    static constexpr std::size_t most_stops = 12;
    static constexpr VariableId none = -1;

    struct Need {  // lacking, it costs at least this much
        FactId fact;
        double cost;
    };
    struct Part {  // of the goal
        FactId goal;
        std::vector<Need> needs;  // the goal itself first
        int stop = -1;            // in the tour, if any
    };

    const Question& question_;
    const Table<std::int32_t>& achievers_;
    std::vector<char> possible_;        // operators whose preconditions can ever hold
    std::vector<char> is_charged_;      // operators
    VariableId mover_ = none;
    std::vector<std::int32_t> stops_;   // values of the mover
    std::vector<std::vector<double>> distance_;  // [stop][value]: from the value to the stop
    std::vector<double> tour_;          // [set of stops * number of stops + first of them]: the rest of the tour
    std::vector<Part> parts_;

    void find_possible();
    std::vector<OperatorId> achievers_of(FactId fact) const;
    std::int32_t place_needed(FactId goal, VariableId variable) const;  // 0: none, or not one
    bool moves(OperatorId id, VariableId variable) const;
    void choose_mover();
    void measure_distances();
    void plan_tours();
    void list_parts();
    bool charge(FactId fact, std::vector<Need>& needs);
};

}  // namespace explicable
