#include "mindahl/campaign/tracker.h"

#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::campaign {
namespace {

std::vector<CycleFit> FitBatch(const identification::FitOptions& options,
                               const std::vector<Cycle>& cycles) {
  CycleFitter fitter(options);
  std::vector<CycleFit> fits;
  fits.reserve(cycles.size());
  for (const Cycle& cycle : cycles) fits.push_back(fitter.Fit(cycle));
  return fits;
}

using Batch = std::packaged_task<std::vector<CycleFit>()>;

void RequireCount(const char* quantity, std::size_t count) {
  if (count < 1) ThrowInvalid(quantity, 0, "must be >= 1");
}

}  // namespace

/// Threads that fit batches in the order in which these are begun, no more than there are batches.
class Tracker::Workers {
 public:
  explicit Workers(std::size_t most) : most_(most) {}
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  /// Abandons the batches that no thread has begun to fit.
  ~Workers() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    waiting_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  [[nodiscard]] std::size_t most() const { return most_; }

  std::future<std::vector<CycleFit>> Begin(Batch batch) {
    std::future<std::vector<CycleFit>> fits = batch.get_future();
    {
      const std::lock_guard lock(mutex_);
      batches_.push_back(std::move(batch));
    }
    if (threads_.size() < most_) {
      StartThread();
    } else {
      waiting_.notify_one();
    }
    return fits;
  }

 private:
  /// Starts a thread, or makes do with the running ones where the system gives no other.
  /// @throws std::system_error where there is none
  void StartThread() {
    try {
      threads_.emplace_back([this] { Work(); });
    } catch (const std::system_error&) {
      if (threads_.empty()) throw;
      most_ = threads_.size();
      waiting_.notify_one();
    }
  }

  void Work() {
    for (;;) {
      std::unique_lock lock(mutex_);
      waiting_.wait(lock, [this] { return is_over_ || !batches_.empty(); });
      if (is_over_) return;
      Batch batch = std::move(batches_.front());
      batches_.pop_front();
      lock.unlock();
      batch();
    }
  }

  std::size_t most_;
  std::mutex mutex_;
  std::condition_variable waiting_;
  std::deque<Batch> batches_;
  bool is_over_ = false;
  std::vector<std::thread> threads_;
};

Tracker::Tracker(TrackOptions options, Done done)
    : options_(std::move(options)),
      done_(std::move(done)),
      splitter_(options_.fit.preparation.reversal_gate.value_or(0.0), options_.together,
                options_.seed) {
  RequireCount("fits to choose one of [-]", options_.every);
  RequireCount("threads [-]", options_.threads);
  if (options_.skipped % kBatch != 0) {
    ThrowInvalid("skipped fits [-]", static_cast<double>(options_.skipped),
                 "must be a multiple of a batch");
  }
  const CycleFitter refused_here(options_.fit);  // and not in a thread
  workers_ = std::make_unique<Workers>(options_.threads);
}

Tracker::~Tracker() {
  // Tasks that nobody begins are then nobody's: the end of one that somebody waits for allocates.
  begun_.clear();
}

void Tracker::Add(const loop::RecordView& samples, std::span<const std::size_t> lines) {
  cycles_.clear();
  splitter_.Add(samples, lines, cycles_);
  for (Cycle& cycle : cycles_) {
    if (pieces_++ % options_.every != 0) continue;
    if (fits_++ < options_.skipped) continue;
    batch_.push_back(std::move(cycle));
    if (batch_.size() == kBatch) Begin();
  }
}

void Tracker::Finish() {
  if (!batch_.empty()) Begin();
  while (!begun_.empty()) Deliver();
}

void Tracker::Begin() {
  // One that waits for each that is fitted: no thread waits for the reader while this one waits.
  while (begun_.size() >= 2 * workers_->most()) Deliver();
  begun_.push_back(workers_->Begin(Batch([&fit = options_.fit, cycles = std::exchange(batch_, {})] {
    return FitBatch(fit, cycles);
  })));
  batch_.reserve(kBatch);
}

void Tracker::Deliver() {
  const std::vector<CycleFit> fits = begun_.front().get();
  begun_.pop_front();
  done_(fits);
}

}  // namespace mindahl::campaign
