use crate::*; 
