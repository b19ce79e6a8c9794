// What all searches share: the question, the limits, and an engine that can be run in slices.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "search/prepared_task.hpp"
#include "task/state.hpp"

namespace explicable {

constexpr double dead_end = std::numeric_limits<double>::infinity();
constexpr std::int64_t no_max_cost = std::numeric_limits<std::int64_t>::max();

// From where, to where. The goal may differ from the task's own.
struct Question {
    Question(const PreparedTask& prepared_task, State start, std::vector<FactId> goal_facts)
        : prepared(prepared_task),
          task(prepared.task()),
          successors(prepared.successors()),
          initial(std::move(start)),
          goal(std::move(goal_facts)) {}

    const PreparedTask& prepared;
    const Task& task;
    const SuccessorGenerator& successors;
    State initial;
    std::vector<FactId> goal;

    bool is_goal(const State& state) const {
        for (const FactId fact : goal) {
            if (!state.holds(task, fact)) return false;
        }
        return true;
    }
};

struct Limits {
    double time_s = std::numeric_limits<double>::infinity();
    std::size_t memory_bytes = std::numeric_limits<std::size_t>::max();
    std::int64_t evaluations = std::numeric_limits<std::int64_t>::max();
};

enum class Stop { none, time, memory, evaluations, interrupt };

constexpr std::string_view name_of(Stop stop) {
    constexpr std::string_view names[] = {"", "time", "memory", "evaluations", "interrupt"};
    return names[static_cast<int>(stop)];
}

// Counts the work of a search, whatever engines it is made of, and says when to stop.
class Monitor {
public:
    // `interrupted` is asked about twenty times a second.
    Monitor(const Limits& limits, std::function<bool()> interrupted)
        : limits_(limits), interrupted_(std::move(interrupted)), start_(Clock::now()), next_poll_(start_) {}

    std::int64_t evaluations = 0, expansions = 0;

    // To be called once a step of the search; `memory` gives the bytes in use.
    template <class Memory>
    bool may_go_on(const Memory& memory) {
        if (evaluations >= limits_.evaluations) stop_ = Stop::evaluations;
        look_at_the_clock();
        if ((++steps_ & 31) == 0 && memory() > limits_.memory_bytes) stop_ = Stop::memory;
        return stop_ == Stop::none;
    }
    // For what takes long within a step.
    bool is_time_up() {
        look_at_the_clock();
        return stop_ != Stop::none;
    }
    void out_of_memory() { stop_ = Stop::memory; }
    Stop stop() const { return stop_; }
    double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
    using Clock = std::chrono::steady_clock;
    Limits limits_;
    std::function<bool()> interrupted_;
    Clock::time_point start_, next_poll_;
    std::uint64_t steps_ = 0;
    Stop stop_ = Stop::none;

    void look_at_the_clock() {
        const auto now = Clock::now();
        if (std::chrono::duration<double>(now - start_).count() >= limits_.time_s) stop_ = Stop::time;
        if (now < next_poll_) return;
        next_poll_ = now + std::chrono::milliseconds(50);
        if (interrupted_ && interrupted_()) stop_ = Stop::interrupt;
    }
};

enum class Status {
    solved,     // plan() is one
    exhausted,  // nothing is left to look at
    paused,     // the slice is used up
    stopped     // the monitor said so
};

class Engine {
public:
    virtual ~Engine() = default;
    // Searches on, for about `slice` more evaluations. After `solved`, a further call looks for another plan
    // where the engine can do so, else it is `exhausted`.
    virtual Status run(Monitor& monitor, std::int64_t slice) = 0;
    virtual std::vector<OperatorId> plan() const = 0;
    virtual std::size_t memory_bytes() const = 0;
    // Does `exhausted` prove that there is no plan (better than the bound, if one was given)?
    virtual bool is_complete() const { return true; }
};

// The number of evaluations at which a slice that begins now is used up.
inline std::int64_t end_of_slice(const Monitor& monitor, std::int64_t slice) {
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    return slice > most - monitor.evaluations ? most : monitor.evaluations + slice;
}

// With two queues: how many pops preferred operators are given for each progress (Richter & Helmert 2009).
constexpr std::int64_t preferred_boost = 1000;

// Shuffles ties; seed 0 leaves them in the order of generation.
class TieBreaker {
public:
    explicit TieBreaker(std::uint64_t seed) : state_(seed) {}

    void shuffle(std::vector<OperatorId>& operators) {
        if (state_ == 0) return;
        for (std::size_t i = operators.size(); i > 1; --i) std::swap(operators[i - 1], operators[next() % i]);
    }

private:
    std::uint64_t state_;
    std::uint64_t next() {  // xorshift64*
        state_ ^= state_ >> 12;
        state_ ^= state_ << 25;
        state_ ^= state_ >> 27;
        return (state_ * 0x2545f4914f6cdd1dULL) >> 11;
    }
};

}  // namespace explicable
