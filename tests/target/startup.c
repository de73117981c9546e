/* Switch the floating-point unit on, then start newlib, whose output goes through the debugger. */
#include <stdint.h>

extern void _start(void);
extern uint32_t __stack;
void reset(void);

void reset(void) {
  *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: CP10 and CP11 */
  __asm volatile("dsb\n isb");
  _start();
  for (;;) {
  }
}

static void stop(void) {
  for (;;) {
  }
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void))&__stack, reset, stop, stop, stop, stop, stop, 0, 0, 0, 0, stop, stop, 0, stop,
    stop};
