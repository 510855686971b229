// What a measurement of time needs to know of the machine: who else used it, and how much memory there is.
#pragma once

#include <optional>

namespace trilens {

/// Watches the machine from its construction on.
class MachineWatch {
  public:
    MachineWatch();

    /// The share of the machine's processor time, 0..1, that other processes used since then; none where the
    /// system does not say.
    std::optional<double> used_by_others() const;

  private:
    std::optional<double> busy_;  // seconds of all processors together
    double own_ = 0, started_ = 0;
};

/// Forgets the largest memory that this process had so far. False where the system cannot.
bool reset_peak_memory();

/// The largest memory that this process had since then, MiB; none where the system does not say.
std::optional<double> peak_memory_mib();

/// Bytes that this process may still take without pushing others out: of the machine, or of its control
/// group where that allows less. None where the system does not say.
std::optional<double> available_memory();

}  // namespace trilens
