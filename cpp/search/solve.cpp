#include "search/solve.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "search/best_first.hpp"
#include "search/heuristics.hpp"
#include "search/hill_climbing.hpp"
#include "search/improve.hpp"
#include "search/lazy.hpp"
#include "search/portfolio.hpp"
#include "search/width.hpp"

namespace explicable {

namespace {

constexpr std::int64_t no_slice = std::numeric_limits<std::int64_t>::max();

class Solver {
public:
    Solver(const Question& question, const SearchOptions& options) : question_(question), options_(options) {}

    std::unique_ptr<Engine> engine() const {
        const std::string& name = options_.algorithm;
        if (name == "default" || name == "anytime") return standard();
        if (name == "lazy") return lazy();
        if (name == "eager") return eager();
        if (name == "ff") return ff();
        if (name == "bfws") return std::make_unique<WidthSearch>(question_, options_.seed);
        if (name == "astar" || name == "wastar") return astar();
        throw std::invalid_argument("unknown search algorithm: " + name);
    }

private:
    const Question& question_;
    const SearchOptions& options_;

    std::unique_ptr<Engine> lazy() const {
        return std::make_unique<LazySearch>(question_, options_.preferred, options_.labelled, options_.seed);
    }
    std::unique_ptr<Engine> eager() const {
        BestFirstOptions best_first;
        best_first.preferred = options_.preferred;
        best_first.labelled = options_.labelled;
        best_first.seed = options_.seed;
        return std::make_unique<BestFirstSearch>(question_, std::move(best_first));
    }
    // Hill-climbing as published, but with a budget: where it works at all it is quick.
    std::unique_ptr<Engine> ff() const {
        auto climb = [this] { return std::make_unique<HillClimbing>(question_, options_.labelled, options_.seed); };
        auto best_first = [this] {
            BestFirstOptions plain;
            plain.labelled = options_.labelled;
            plain.seed = options_.seed;
            return std::make_unique<BestFirstSearch>(question_, std::move(plain));
        };
        return std::make_unique<Portfolio>(std::vector<Portfolio::Member>{{climb, 100'000, 0}, {best_first, no_slice, 1}});
    }
    // Relaxed plans first, since they mostly lead straight to the goal; where they do not, on large grids say, novelty
    // often does. A relaxed plan costs more the larger the task is, hardly so a look at novelty.
    std::unique_ptr<Engine> standard() const {
        if (options_.labelled.scorer) return lazy();
        const std::int64_t size = question_.task.num_facts() + question_.task.num_operators();
        const std::int64_t lazy_slice = std::clamp<std::int64_t>(40'000'000 / (size + 1), 500, 4'000);
        auto width = [this] { return std::make_unique<WidthSearch>(question_, options_.seed); };
        return std::make_unique<Portfolio>(
            std::vector<Portfolio::Member>{{[this] { return lazy(); }, lazy_slice, 2}, {width, 30'000, 3}});
    }
    std::unique_ptr<Engine> astar() const {
        BestFirstOptions best_first;
        best_first.weight_g = 1.0;
        best_first.weight_h = options_.algorithm == "astar" ? 1.0 : options_.weight;
        best_first.reopen = true;
        best_first.seed = options_.seed;
        const std::string fallback = options_.algorithm == "astar" ? "lmcut" : "ff";
        const std::string& name = options_.heuristic.empty() ? fallback : options_.heuristic;
        if (name == "ff" && options_.algorithm == "wastar") {
            best_first.supporter_cost = SupporterCost::plus_one;
        } else {
            best_first.admissible = make_admissible(question_, name);
            if (!best_first.admissible) throw std::invalid_argument("unknown heuristic: " + name);
        }
        return std::make_unique<BestFirstSearch>(question_, std::move(best_first));
    }
};

// Searches that stop at their first plan.
void find_plan(const Question& question, Engine& engine, Monitor& monitor, Incumbent& best, SearchAnswer& answer) {
    const Status status = engine.run(monitor, no_slice);
    answer.memory_bytes = engine.memory_bytes();
    if (status == Status::solved) best.offer(engine.plan(), question);
    answer.is_exhausted = status == Status::exhausted && engine.is_complete();
}

}  // namespace

SearchAnswer solve(const Question& question, const SearchOptions& options, Monitor& monitor) {
    SearchAnswer answer;
    Incumbent best{options.labelled.scorer, options.alpha, options.ratio};
    try {
        SearchOptions first = options;
        // A first plan is wanted soon; the search that improves it has its own way of closing nodes.
        if (options.algorithm == "anytime") first.labelled.closing = Closing::state;
        const Solver solver(question, first);
        find_plan(question, *solver.engine(), monitor, best, answer);
        answer.is_optimal = best.plan && options.algorithm == "astar";
        if (options.algorithm == "anytime" && best.plan && monitor.stop() == Stop::none) {
            improve(question, options, monitor, best, answer);
        }
    } catch (const std::bad_alloc&) {
        monitor.out_of_memory();
    }
    answer.stop = monitor.stop();
    answer.outcome = answer.stop == Stop::interrupt ? Outcome::interrupted
                     : best.plan                    ? Outcome::solved
                     : answer.is_exhausted          ? Outcome::unsolvable
                                                    : Outcome::limit;
    answer.cost = best.cost;
    answer.objective = best.objective;
    if (answer.is_optimal) answer.lower_bound = best.objective;
    answer.plan = std::move(best.plan);
    answer.evaluations = monitor.evaluations;
    answer.expansions = monitor.expansions;
    answer.search_s = monitor.elapsed_s();
    return answer;
}

}  // namespace explicable
