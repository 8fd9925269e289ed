#pragma once

// The part of HIPRT's device interface that kernels/gpu/hiprt_tracer.h uses, for the host: rays are recorded, answers
// are given beforehand. Names and meanings are HIPRT's.

#include <functional>
#include <vector>

struct FakeFloat2 {
    float x, y;
};
struct FakeFloat3 {
    float x, y, z;
};

struct hiprtRay {
    FakeFloat3 origin;
    float minT = 0;
    FakeFloat3 direction;
    float maxT = 3.4e38f;
};

struct hiprtHit {
    unsigned instanceID = ~0u, primID = ~0u;
    FakeFloat2 uv{};
    FakeFloat3 normal{};
    float t = -1;
    bool hasHit() const { return primID != ~0u; }
};

enum hiprtTraversalState { hiprtTraversalStateFinished, hiprtTraversalStateHit, hiprtTraversalStateStackOverflow };
enum hiprtTraversalHint { hiprtTraversalHintDefault, hiprtTraversalHintShadowRays };

using hiprtScene = struct FakeScene*;
using hiprtFuncTable = struct FakeTable*;
struct FakeTable {};

/// What a traversal was asked.
struct FakeQuery {
    bool any_hit;
    hiprtRay ray;
    unsigned mask;
    hiprtTraversalHint hint;
    void* payload;
    hiprtFuncTable table;
    float time;
};

struct FakeScene {
    std::vector<FakeQuery> queries;
    std::function<hiprtHit(const FakeQuery&)> answer;  ///< may change the payload, as a filter function does
    hiprtTraversalState state = hiprtTraversalStateFinished;
};

struct hiprtPrivateStack {};
struct hiprtEmptyInstanceStack {};

template <bool kAnyHit>
class FakeTraversal {
public:
    FakeTraversal(hiprtScene scene, const hiprtRay& ray, hiprtPrivateStack&, hiprtEmptyInstanceStack&, unsigned mask,
                  hiprtTraversalHint hint, void* payload, hiprtFuncTable table, unsigned, float time)
        : scene_(scene) {
        scene_->queries.push_back({kAnyHit, ray, mask, hint, payload, table, time});
    }
    hiprtHit getNextHit() { return scene_->answer ? scene_->answer(scene_->queries.back()) : hiprtHit{}; }
    hiprtTraversalState getCurrentState() const { return scene_->state; }

private:
    hiprtScene scene_;
};
template <class Stack, class InstanceStack>
using hiprtSceneTraversalClosestCustomStack = FakeTraversal<false>;
template <class Stack, class InstanceStack>
using hiprtSceneTraversalAnyHitCustomStack = FakeTraversal<true>;
