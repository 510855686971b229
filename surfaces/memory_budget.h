// Memory: what does not fit into the machine is refused before it starts; values made on demand are kept
// within a budget of bytes.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace trilens {

// What does not fit into the machine's memory is refused before it starts.

/// Bytes of physical memory of this machine.
double machine_memory();

/// Work that is about to start.
struct MemoryNeed {
    double bytes = 0;
    std::string what;    // "the limit surface of 70000 faces"
    std::string advice;  // what makes it less: "use a cage of fewer faces"
};

struct MemoryLimit {
    double bytes = 0;
    std::string name;  // of what is refused beyond it: a mesh, a file
};

/// Throws InputError(limit.name, "", ...) with the estimate and the advice where the need is above the limit.
void check_memory(const MemoryNeed& need, const MemoryLimit& limit);

// Values made on demand and kept within a budget of bytes, for many threads at once.

/// The values of keys 0 .. count - 1, each a function of its key alone. The first ones asked for stay for
/// good until `kept` bytes are full, and are read without a lock; of the others the latest ones stay, up to
/// `recent` bytes. Value has `std::size_t bytes() const`. Thread-safe.
template <class Value>
class BoundedCache {
  public:
    struct Budget {
        std::size_t kept = 0, recent = 0;
    };

    BoundedCache(std::size_t count, const Budget& budget) : budget_(budget), kept_(count) {}
    BoundedCache(const BoundedCache&) = delete;
    BoundedCache& operator=(const BoundedCache&) = delete;
    ~BoundedCache() {
        for (const auto& slot : kept_) delete slot.load();
    }

    /// use(value) of the key's value, which make(key) makes unless it is there. Threads that ask for a key at
    /// the same time may each make it. What `use` returns must not refer to the value.
    template <class Make, class Use>
    auto with(std::size_t key, const Make& make, const Use& use) {
        if (const Value* kept = kept_[key].load(std::memory_order_acquire)) return use(*kept);
        Shard& shard = shards_[key % kShards];
        if (const auto recent = shard.find(key)) return use(*recent);
        auto made = std::make_unique<const Value>(make(key));
        if (const Value* kept = keep(key, made)) return use(*kept);
        const std::shared_ptr<const Value> recent(std::move(made));
        shard.add(key, recent, budget_.recent / kShards);
        return use(*recent);
    }

    /// Bytes of all values that are there, and of the table of keys: at most both budgets, the table, and
    /// one value per shard.
    std::size_t bytes() {
        std::size_t sum = kept_bytes_.load() + kept_.size() * sizeof(kept_[0]);
        for (Shard& shard : shards_) {
            const std::lock_guard lock(shard.mutex);
            sum += shard.bytes;
        }
        return sum;
    }

  private:
    static constexpr std::size_t kShards = 64;

    /// Some of the keys: their values in the order of use, latest first.
    struct Shard {
        using Entry = std::pair<std::size_t, std::shared_ptr<const Value>>;

        std::mutex mutex;
        std::list<Entry> latest;
        std::unordered_map<std::size_t, typename std::list<Entry>::iterator> place;
        std::size_t bytes = 0;

        std::shared_ptr<const Value> find(std::size_t key) {
            const std::lock_guard lock(mutex);
            const auto found = place.find(key);
            if (found == place.end()) return nullptr;
            latest.splice(latest.begin(), latest, found->second);
            return found->second->second;
        }

        /// The value itself stays even where it alone is above the budget.
        void add(std::size_t key, const std::shared_ptr<const Value>& value, std::size_t budget) {
            const std::lock_guard lock(mutex);
            if (place.count(key) > 0) return;
            latest.emplace_front(key, value);
            place[key] = latest.begin();
            bytes += value->bytes();
            while (bytes > budget && latest.size() > 1) {
                bytes -= latest.back().second->bytes();
                place.erase(latest.back().first);
                latest.pop_back();
            }
        }
    };

    /// The value that stays for good at the key, `made` or another thread's; none where the budget is full.
    const Value* keep(std::size_t key, std::unique_ptr<const Value>& made) {
        const std::size_t bytes = made->bytes();
        if (kept_bytes_.fetch_add(bytes) + bytes > budget_.kept) {
            kept_bytes_.fetch_sub(bytes);
            return nullptr;
        }
        const Value* other = nullptr;
        if (kept_[key].compare_exchange_strong(other, made.get())) return made.release();
        kept_bytes_.fetch_sub(bytes);
        made.reset();
        return other;
    }

    Budget budget_;
    std::atomic<std::size_t> kept_bytes_{0};
    std::vector<std::atomic<const Value*>> kept_;
    std::array<Shard, kShards> shards_;
};

}  // namespace trilens
