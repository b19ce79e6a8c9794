// Enforced hill-climbing with helpful actions (Hoffmann & Nebel 2001).
#pragma once

#include <memory>
#include <vector>

#include "search/evaluator.hpp"

namespace explicable {

// From each state, breadth-first search over helpful actions finds one with a lower heuristic value, and goes there. Fast where
// it works, but it commits itself, so its failure proves nothing.
class HillClimbing : public Engine {
public:
    HillClimbing(const Question& question, LabelledOptions labelled, std::uint64_t seed);

    Status run(Monitor& monitor, std::int64_t slice) override;
    std::vector<OperatorId> plan() const override { return plan_; }
    std::size_t memory_bytes() const override;
    bool is_complete() const override { return false; }

private:
    struct Branch {
        NodeId node;
        OperatorId step;
    };

    const Question& question_;
    LabelledOptions labelled_;
    Evaluator evaluator_;
    TieBreaker ties_;
    std::unique_ptr<NodeStore> nodes_;  // of the present breadth-first search
    std::vector<Branch> queue_;
    std::size_t next_ = 0;
    double best_h_ = dead_end;
    std::vector<OperatorId> plan_;
    State state_;
    std::vector<OperatorId> applicable_, helpful_;
    bool started_ = false, done_ = false;

    double visit(NodeId node, Monitor& monitor);
    void enqueue(NodeId node, Monitor& monitor);
    void commit(NodeId node, double h, Monitor& monitor);
};

}  // namespace explicable
