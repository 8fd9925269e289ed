#include "base/detached_work.h"

#include <atomic>

namespace kadr {
namespace {

std::atomic<int> g_running{0};

}  // namespace

DetachedWork::DetachedWork() { ++g_running; }
DetachedWork::~DetachedWork() { --g_running; }
bool DetachedWork::is_running() { return g_running > 0; }

}  // namespace kadr
