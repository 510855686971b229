#include "view/drawing_thread.h"

#include <trilens/error.h>

#include <new>

namespace trilens {

using Clock = std::chrono::steady_clock;

namespace {

/// Pictures of many samples are begun once nothing was asked for so long: while a hand moves they would only
/// be thrown away, and hold up the next picture meanwhile.
constexpr std::chrono::milliseconds kRest(120);

}  // namespace

DrawingThread::DrawingThread() : thread_([this] { run(); }) {}

DrawingThread::~DrawingThread() {
    {
        const std::scoped_lock lock(mutex_);
        stops_ = true;
        cancel_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

std::uint64_t DrawingThread::ask(const Session& session) {
    const std::scoped_lock lock(mutex_);
    if (asked_)
        ++times_.dropped;
    else
        asked_at_ = Clock::now();
    asked_ = DrawOrder{++last_asked_, session.file, session.folder, session.now};
    if (last_shown_ == last_begun_) cancel_ = true;  // what is drawn now only makes it better
    changed_.notify_all();
    return last_asked_;
}

std::shared_ptr<const Drawn> DrawingThread::latest() const {
    const std::scoped_lock lock(mutex_);
    return latest_;
}

bool DrawingThread::is_done() const {
    const std::scoped_lock lock(mutex_);
    return last_done_ == last_asked_;
}

bool DrawingThread::is_shown() const {
    const std::scoped_lock lock(mutex_);
    return last_shown_ == last_asked_ || last_done_ == last_asked_;
}

namespace {

std::chrono::duration<double> wait_time(double seconds) {
    return std::chrono::duration<double>(seconds);
}

}  // namespace

bool DrawingThread::wait_done(double seconds) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, wait_time(seconds), [this] { return last_done_ == last_asked_; });
}

bool DrawingThread::wait_shown(double seconds) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, wait_time(seconds),
                             [this] { return last_shown_ == last_asked_ || last_done_ == last_asked_; });
}

void DrawingThread::with_painter(const std::function<void(Painter&)>& work) {
    std::unique_lock lock(mutex_);
    visit_ = &work;
    visit_failed_ = nullptr;
    changed_.notify_all();
    changed_.wait(lock, [this] { return visit_ == nullptr; });
    if (visit_failed_) std::rethrow_exception(visit_failed_);
}

void DrawingThread::notify(std::function<void()> told) {
    const std::scoped_lock lock(told_mutex_);
    told_ = std::move(told);
}

DrawTimes DrawingThread::times() const {
    const std::scoped_lock lock(mutex_);
    return times_;
}

void DrawingThread::publish(const std::string& failure) {
    auto drawn = std::make_shared<Drawn>(painter_.drawn());
    if (!failure.empty()) drawn->error = failure;
    {
        const std::scoped_lock lock(mutex_);
        if (drawn->order == last_begun_ && last_shown_ != last_begun_) {
            last_shown_ = last_begun_;
            times_.latencies.push_back(std::chrono::duration<double>(Clock::now() - begun_asked_at_).count());
        }
        if (failure.empty() && drawn->error.empty() && drawn->order == last_begun_) ++times_.pictures;
        if (painter_.next() == DrawStage::kDone || !failure.empty()) last_done_ = last_begun_;
        latest_ = std::move(drawn);
    }
    changed_.notify_all();
    const std::scoped_lock lock(told_mutex_);
    if (told_) told_();
}

void DrawingThread::visit() {
    std::exception_ptr failed;
    try {
        (*visit_)(painter_);
    } catch (...) {
        failed = std::current_exception();
    }
    {
        const std::scoped_lock lock(mutex_);
        visit_failed_ = failed;
        visit_ = nullptr;
    }
    changed_.notify_all();
}

void DrawingThread::run() {
    for (;;) {
        std::optional<DrawOrder> order;
        bool visits = false;
        {
            std::unique_lock lock(mutex_);
            const auto is_asked = [this] { return stops_ || asked_ || visit_; };
            if (last_done_ != last_begun_ && painter_.next() >= DrawStage::kFine)
                changed_.wait_until(lock, begun_asked_at_ + kRest, is_asked);
            changed_.wait(lock, [&] { return is_asked() || last_done_ != last_begun_; });
            if (stops_) return;
            cancel_ = false;
            order.swap(asked_);
            visits = visit_ != nullptr;
            if (order) {
                last_begun_ = order->number;
                begun_asked_at_ = asked_at_;
            }
        }
        if (visits) visit();
        std::string failure;
        try {
            if (order) painter_.begin(*order);
            if (painter_.next() != DrawStage::kDone) painter_.draw_next({nullptr, &cancel_});
        } catch (const Interrupted&) {
            continue;
        } catch (const std::bad_alloc&) {
            failure = "out of memory";
        }
        if (order || last_done_ != last_begun_) publish(failure);
    }
}

}  // namespace trilens
