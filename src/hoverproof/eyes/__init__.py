"""Images: tags found in them, what they tell, and images made of a flight."""
