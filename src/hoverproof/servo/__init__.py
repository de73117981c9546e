"""The laws, and what follows of them: controller, Lyapunov function, closed loop."""
