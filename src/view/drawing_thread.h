// A thread that draws the newest state, stage by stage; pictures are whole when they are handed out.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "view/painter.h"

namespace trilens {

/// When a state was asked for and when its first picture was there, seconds between them; since the thread
/// began.
struct DrawTimes {
    std::vector<double> latencies;  // of each state that was drawn
    std::size_t pictures = 0;       // that were handed out: first ones, and better ones
    std::size_t dropped = 0;        // states that newer ones overtook before they were begun
};

/// What is asked last is drawn next. A stage that brings a state's first picture is finished, so that
/// pictures come however fast states change; later ones end at once where a newer state is there.
class DrawingThread {
  public:
    DrawingThread();
    ~DrawingThread();
    DrawingThread(const DrawingThread&) = delete;
    DrawingThread& operator=(const DrawingThread&) = delete;

    /// Asks for a state; returns at once. The order's number.
    std::uint64_t ask(const Session& session);

    /// The newest whole pictures; null before the first. Never waits for drawing.
    std::shared_ptr<const Drawn> latest() const;

    /// Whether everything of the newest state is drawn, or its error known.
    bool is_done() const;
    /// Whether the newest state has a picture, or its error is known.
    bool is_shown() const;
    /// Waits for that, or for as many seconds; whether it is done.
    bool wait_done(double seconds) const;
    /// Waits until the newest state has a picture, or an error, or for as many seconds.
    bool wait_shown(double seconds) const;

    /// Does work with what draws, when the stage of now is over, and waits for it; what it throws comes out
    /// here.
    void with_painter(const std::function<void(Painter&)>& work);

    DrawTimes times() const;

    /// From now on `told` is called from the thread whenever there is something new to show; it must not call
    /// back. An empty one: nobody is told, and nobody is being told any more when this returns.
    void notify(std::function<void()> told);

  private:
    void run();
    void visit();
    void publish(const std::string& failure);

    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    std::optional<DrawOrder> asked_;
    std::chrono::steady_clock::time_point asked_at_, begun_asked_at_;
    std::uint64_t last_asked_ = 0, last_begun_ = 0, last_shown_ = 0, last_done_ = 0;  // orders' numbers
    const std::function<void(Painter&)>* visit_ = nullptr;
    std::exception_ptr visit_failed_;
    std::shared_ptr<const Drawn> latest_;
    DrawTimes times_;
    std::atomic<bool> cancel_{false};
    bool stops_ = false;
    std::mutex told_mutex_;
    std::function<void()> told_;
    Painter painter_;
    std::thread thread_;
};

}  // namespace trilens
