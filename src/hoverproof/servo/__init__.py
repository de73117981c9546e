"""The control design: error chain, controller, Lyapunov function."""
