"""The world: rigid body, camera, rotors, and the hover asked for."""
