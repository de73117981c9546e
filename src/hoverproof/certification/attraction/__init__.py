"""A proved region of attraction: where the controller may be switched on."""
