#include "search/outlook.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <queue>

#include "search/open_list.hpp"
#include "task/successor.hpp"

namespace explicable {

namespace {

constexpr std::int32_t max_states = 100'000, max_places = 250'000;

std::size_t padded(std::size_t size) {
    constexpr std::size_t alignment = alignof(std::max_align_t);
    return (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment;
}

}  // namespace

// Dijkstra's algorithm, backwards.
void StepGraph::sweep(std::vector<double>& ahead) const {
    std::vector<std::int32_t> first(ahead.size() + 1, 0), into(edges.size());
    for (const Edge& edge : edges) ++first[edge.to + 1];
    for (std::size_t place = 0; place < ahead.size(); ++place) first[place + 1] += first[place];
    std::vector<std::int32_t> next(first.begin(), first.end() - 1);
    for (std::size_t edge = 0; edge < edges.size(); ++edge) into[next[edges[edge].to]++] = static_cast<std::int32_t>(edge);

    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::size_t place = 0; place < ahead.size(); ++place) {
        if (ahead[place] < dead_end) queue.emplace(ahead[place], static_cast<std::int32_t>(place));
    }
    while (!queue.empty()) {
        const auto [value, place] = queue.top();
        queue.pop();
        if (value > ahead[place]) continue;
        for (std::int32_t i = first[place]; i < first[place + 1]; ++i) {
            const Edge& edge = edges[into[i]];
            if (value + edge.weight >= ahead[edge.from]) continue;
            ahead[edge.from] = value + edge.weight;
            queue.emplace(ahead[edge.from], edge.from);
        }
    }
}

void StepGraph::reverse() {
    for (Edge& edge : edges) std::swap(edge.from, edge.to);
}

CostToGo::CostToGo(const Question& question, const StatePacker& packer, std::int64_t max_cost)
    : question_(question), packer_(packer), max_cost_(max_cost), states_(packer.num_words()) {}

// Expands states in the order of their numbers; returns how many.
std::int32_t CostToGo::expand(Monitor& monitor, std::int32_t limit, StepGraph& graph) {
    std::vector<Word> words(packer_.num_words());
    std::vector<OperatorId> applicable;
    std::int32_t next = 0;
    for (; next < states_.size() && states_.size() <= limit; ++next) {
        if (!monitor.may_go_on([&] { return states_.memory_bytes() + graph.edges.capacity() * sizeof(StepGraph::Edge); })) break;
        question_.successors.applicable(packer_.unpack(states_[next]), applicable);
        for (const OperatorId step : applicable) {
            apply(question_.task, packer_, step, states_[next], words.data());
            const StateId to = states_.insert(words.data()).first;
            if (to != next) graph.edges.push_back({next, to, step, static_cast<double>(question_.task.cost[step])});
        }
    }
    costs_.clear();
    for (StateId state = 0; state < states_.size(); ++state)
        costs_.push_back(question_.is_goal(packer_.unpack(states_[state])) ? 0.0 : dead_end);
    return next;
}

void CostToGo::list(Monitor& monitor, std::int32_t limit) {
    std::vector<Word> words(packer_.num_words());
    StepGraph graph;
    packer_.pack(question_.initial, words.data());
    states_.insert(words.data());
    if (expand(monitor, limit, graph) < states_.size()) {
        states_ = StateRegistry(packer_.num_words());
        costs_.clear();
        heuristic_ = make_admissible(question_, "lmcut");
        return;
    }
    sweep(graph);
}

void CostToGo::list_near(Monitor& monitor, const std::vector<OperatorId>& plan, std::int32_t limit) {
    std::vector<Word> from(packer_.num_words()), to(packer_.num_words());
    StepGraph graph;
    packer_.pack(question_.initial, from.data());
    states_.insert(from.data());
    for (const OperatorId step : plan) {
        apply(question_.task, packer_, step, from.data(), to.data());
        std::swap(from, to);
        states_.insert(from.data());
    }
    expand(monitor, std::max(limit, 2 * states_.size()), graph);
    sweep(graph);
}

void CostToGo::sweep(StepGraph& graph) {
    graph.sweep(costs_);
    if (max_cost_ == no_max_cost) return;
    std::vector<double> so_far(costs_.size(), dead_end);
    so_far[0] = 0.0;  // the initial state is listed first
    graph.reverse();
    graph.sweep(so_far);
    for (std::size_t state = 0; state < costs_.size(); ++state) {
        if (so_far[state] + costs_[state] > static_cast<double>(max_cost_)) costs_[state] = dead_end;
    }
}

double CostToGo::operator()(const Word* words) const {
    if (heuristic_) return heuristic_->evaluate(packer_.unpack(words));
    const StateId state = states_.find(words);
    return state >= 0 ? costs_[state] : dead_end;
}

std::size_t CostToGo::memory_bytes() const { return states_.memory_bytes() + costs_.capacity() * sizeof(double); }

Outlook::Outlook(const Question& question, const PathScorer* scorer, double alpha, std::int64_t max_cost)
    : question_(question),
      scorer_(scorer && scorer->has_bounds() && (alpha > 0.0 || scorer->charges()) ? scorer : nullptr),
      alpha_(alpha),
      max_cost_(max_cost),
      packer_(question.task),
      cost_to_go_(question, packer_, max_cost),
      places_(packer_.num_words() + 1),
      contexts_(padded(scorer_ ? scorer_->context_size() : 0)),
      key_(packer_.num_words() + 1) {}

bool Outlook::prepare(Monitor& monitor, double bound, const Offer& offer) {
    cost_to_go_.list(monitor, max_states);
    return sweep(monitor, bound, offer);
}

bool Outlook::prepare_near(Monitor& monitor, const std::vector<OperatorId>& plan, std::int32_t limit, double bound,
                           const Offer& offer) {
    cost_to_go_.list_near(monitor, plan, limit);
    return sweep(monitor, bound, offer);
}

bool Outlook::sweep(Monitor& monitor, double bound, const Offer& offer) {
    if (monitor.stop() != Stop::none) return false;
    is_complete_ = cost_to_go_.is_exact() && !scorer_;
    // Without exact costs, contexts are more than can be listed too.
    if (!scorer_ || !cost_to_go_.is_exact()) return true;
    if (!list(monitor, bound, offer)) return false;
    weigh();
    graph_.sweep(ahead_);
    graph_.edges = {};
    return true;
}

// A* by the bounds that are known so far; of the contexts with one outlook key the first stands for all, widened by the others.
// What is left out is worth its cost-to-go, so that stopping here or there makes the outlook less tight, but never wrong.
bool Outlook::list(Monitor& monitor, double bound, const Offer& offer) {
    struct Arrival {
        double value = dead_end;  // cost + alpha * inexplicable steps, at the least
        std::int32_t parent = -1;
        OperatorId step = -1;
        bool is_closed = false;
    };
    const std::size_t size = scorer_->context_size();
    std::vector<std::byte> context(size);
    std::vector<Word> words(packer_.num_words());
    std::vector<OperatorId> applicable;
    std::vector<Arrival> arrivals;
    OpenList<std::int32_t> open;

    // The place's number, or -1 if no better plan leads through it.
    const auto arrive = [&](const Word* state, double value, std::int32_t parent, OperatorId step) {
        const double least = value + cost_to_go_(state);
        if (least >= bound) return -1;
        const auto [place, is_new] = places_.insert(with_key(state, context.data()));
        if (is_new) {
            std::memcpy(contexts_.append(), context.data(), size);
            arrivals.emplace_back();
            ahead_.push_back(dead_end);
        }
        scorer_->widen(contexts_.row(place), context.data());
        if (value < arrivals[place].value && !arrivals[place].is_closed) {
            arrivals[place] = {value, parent, step, false};
            open.push({least, least - value}, place);
        }
        return place;
    };
    const auto path = [&](std::int32_t place) {
        std::vector<OperatorId> steps;
        for (; arrivals[place].parent >= 0; place = arrivals[place].parent) steps.push_back(arrivals[place].step);
        std::reverse(steps.begin(), steps.end());
        return steps;
    };

    packer_.pack(question_.initial, words.data());
    scorer_->root(question_.initial, context.data());
    arrive(words.data(), 0.0, -1, -1);
    while (!open.empty() && open.lowest().first < bound && places_.size() <= max_places) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return false;
        const std::int32_t place = open.pop();
        if (arrivals[place].is_closed) continue;
        arrivals[place].is_closed = true;
        const State before = packer_.unpack(places_[place]);
        if (question_.is_goal(before)) bound = std::min(bound, offer(path(place)));
        question_.successors.applicable(before, applicable);
        for (const OperatorId step : applicable) {
            apply(question_.task, packer_, step, places_[place], words.data());
            const State after = packer_.unpack(words.data());
            scorer_->extend(contexts_.row(place), step, before, after, context.data());
            const double charge = scorer_->charge(context.data()) - scorer_->charge(contexts_.row(place));
            const double cost = question_.task.cost[step] + charge;
            const double growth = scorer_->least_growth(contexts_.row(place), step, context.data());
            const std::int32_t to = arrive(words.data(), arrivals[place].value + cost + alpha_ * growth, place, step);
            if (to >= 0) graph_.edges.push_back({place, to, step, cost});
            else ahead_[place] = std::min(ahead_[place], cost + cost_to_go_(words.data()));
        }
    }
    is_complete_ = open.empty() || open.lowest().first >= bound;
    for (std::int32_t place = 0; place < places_.size(); ++place) {
        if (!arrivals[place].is_closed) ahead_[place] = cost_to_go_(places_[place]);
    }
    return true;
}

// Now that all contexts of a key have been seen, the bounds hold for all of them.
void Outlook::weigh() {
    for (auto& edge : graph_.edges) {
        edge.weight += alpha_ * scorer_->least_growth(contexts_.row(edge.from), edge.step, contexts_.row(edge.to));
    }
    for (std::int32_t place = 0; place < places_.size(); ++place) {
        if (cost_to_go_(places_[place]) > 0.0 || !question_.is_goal(packer_.unpack(places_[place]))) continue;
        ahead_[place] = std::min(ahead_[place], alpha_ * scorer_->least_end(contexts_.row(place)));
    }
}

const Word* Outlook::with_key(const Word* words, const std::byte* context) const {
    std::copy_n(words, packer_.num_words(), key_.data());
    key_.back() = scorer_->outlook_key(context);
    return key_.data();
}

double Outlook::operator()(const Word* words, const std::byte* context) const {
    if (!scorer_ || ahead_.empty()) return cost_to_go_(words);
    const StateId place = places_.find(with_key(words, context));
    return place >= 0 ? ahead_[place] : cost_to_go_(words);
}

double Outlook::from_start() const {
    std::vector<Word> words(packer_.num_words());
    packer_.pack(question_.initial, words.data());
    std::vector<std::byte> context(scorer_ ? scorer_->context_size() : 0);
    if (scorer_) scorer_->root(question_.initial, context.data());
    return (*this)(words.data(), context.data());
}

std::size_t Outlook::memory_bytes() const {
    return cost_to_go_.memory_bytes() + places_.memory_bytes() + contexts_.memory_bytes() +
           graph_.edges.capacity() * sizeof(StepGraph::Edge) + ahead_.capacity() * sizeof(double);
}

}  // namespace explicable
