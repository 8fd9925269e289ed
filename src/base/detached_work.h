#pragma once

namespace kadr {

/// Work that cannot be interrupted and that nobody waits for when the program ends: it counts while the object lives, in
/// the thread that does the work.
///
/// A program that ends while there is some leaves at once (std::_Exit): what the thread uses would else be torn down
/// under it.
class DetachedWork {
public:
    DetachedWork();
    ~DetachedWork();
    DetachedWork(const DetachedWork&) = delete;
    DetachedWork& operator=(const DetachedWork&) = delete;

    static bool is_running();
};

}  // namespace kadr
