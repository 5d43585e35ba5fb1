// The traversal that the device and the settings ask for.
#if BRUTE_FORCE
#import geometry/trace_brute_force
#else
#if PACKETS
#import geometry/trace_packet
#else
#import geometry/trace_lane
#endif
#endif
