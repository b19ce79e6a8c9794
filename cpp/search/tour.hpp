// A lower bound for goals that lie in many places of one variable: the shortest tour of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "search/heuristics.hpp"
#include "search/possible.hpp"
#include "task/packed_state.hpp"

namespace explicable {

// The operators that may change one variable.
class Moves {
public:
    Moves(const Task& task, VariableId variable);
    struct Move {
        std::int32_t from;  // -1: any value
        OperatorId by;
    };
    VariableId variable() const { return variable_; }
    const std::vector<char>& operators() const { return operators_; }                // for each whether it is one
    std::span<const Move> to(std::int32_t value) const { return to_[value]; }

private:
    VariableId variable_;
    std::vector<char> operators_;
    Table<Move> to_;
};

// Those of the variable asked about last: mostly it is the same one.
class KnownMoves {
public:
    const Moves& of(const Task& task, VariableId variable) {
        if (!moves_ || moves_->variable() != variable) moves_.emplace(task, variable);
        return *moves_;
    }

private:
    std::optional<Moves> moves_;
};

// Let one variable move, a robot's place say, and forget all else that its moves need. Where everything that achieves a goal
// needs one value of it, that value has to be visited: what all visits cost together is a travelling-salesman path
// without return (Held & Karp 1962) over distances in the variable's transition graph. On top of that, each fact that is
// still lacking and needed in any case costs the cheapest operator that adds it; no operator is charged for twice.
// Exact where other facts of the task hold no move up, as on a floor plan that one robot searches.
class Tour {
public:
    // Of the question's state it matters alone which goals hold there, and what is possible from it on.
    Tour(const Question& question, const std::vector<char>& possible, KnownMoves& moves);
    bool exists() const { return !stops_.empty(); }
    double cost(const State& state) const;
    double cost(const StatePacker& packer, const Word* state) const;
    // A tighter bound: what other stops need may hold and be lost by what has to be done for the first one, and is then to be achieved
    // again. So it is for a robot that has been sent elsewhere than where it should go first, and can be sent to one place at a time.
    double bound(const StatePacker& packer, const Word* state) const;
    bool is_tighter() const { return is_tighter_; }  // the bound, in some states
    std::size_t memory_bytes() const;

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
    struct Loss {  // what a lacking goal needs is lost if another stop than its own comes first, as long as that one's need lacks
        FactId goal, fact, cause;
        double cost;
    };

    const Task& task_;
    const Table<std::int32_t>& achievers_;
    VariableId mover_ = none;
    std::vector<std::int32_t> stops_;   // values of the mover
    std::vector<std::vector<double>> distance_;  // [stop][value]: from the value to the stop
    std::vector<double> tour_;          // [set of stops * number of stops + first of them]: the rest of the tour
    std::vector<Part> parts_;
    std::vector<std::vector<Loss>> losses_;  // by first stop
    bool is_tighter_ = false;
    // While it is made:
    const std::vector<char>* possible_;
    std::vector<char> is_charged_;      // operators

    template <class Holds>
    double cost(const Holds& holds, std::int32_t place, bool with_losses) const;  // the place is the mover's value
    std::vector<OperatorId> achievers_of(FactId fact) const;
    std::int32_t place_needed(FactId goal, VariableId variable) const;  // 0: none, or not one
    void choose_mover(const Question& question);
    void measure_distances(const Moves& moves);
    void plan_tours();
    void list_parts(const std::vector<FactId>& goals);
    bool charge(FactId fact, std::vector<Need>& needs);
    void list_losses();
    FactId cause_of_loss(const Part& first, FactId fact) const;  // -1: none
};

class TourHeuristic : public AdmissibleHeuristic {
public:
    explicit TourHeuristic(Tour tour) : tour_(std::move(tour)) {}
    double evaluate(const State& state) override { return tour_.cost(state); }

private:
    Tour tour_;
};

}  // namespace explicable
