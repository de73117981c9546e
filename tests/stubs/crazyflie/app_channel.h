#pragma once
#include <stddef.h>

#define APPCHANNEL_WAIT_FOREVER (-1)
#define APPCHANNEL_MTU (30)
size_t appchannelReceiveDataPacket(void *buffer, size_t max_length, int timeout_ms);
